#include "node.h"

#include "bytes.h"
#include "crc.h"

enum { STEER_STATE_DATA_ID = 0x10, STEER_COMMAND_DATA_ID = 0x12, STEER_REPLY_DATA_ID = 0x13 };
enum { POT_OK = 0x10, GYRO_OK = 0x20, VREF_OK = 0x40, ESTOP_CLOSED = 0x80 };
enum { COUNTS = 15 };

/* Below 2 % or above 98 % of 65536: a wire is open or shorted. */
enum { RAW_LEAST = 1311, RAW_MOST = 64225 };

enum { URAD_PER_ANGLE_COUNT = 50, URAD_PER_RATE_COUNT = 500 };

static const struct calibration uncalibrated = {{32768, 100000, 32768, 100000, 3300}};

void node_start(struct node *node, const uint8_t block[CALIBRATION_BLOCK])
{
    node->acting = uncalibrated;
    node->calibrated = calibration_from_block(&node->acting, block);
    node->pending = node->acting;
    /* Nothing may be changed before the first sample has shown the circuit to be open. */
    node->estop_closed = true;
    node->counter = 0;
    node->until_diag = 0;
}

static int16_t saturated(int64_t value)
{
    if (value > 32767)
        return 32767;
    return value < -32767 ? (int16_t)-32767 : (int16_t)value;
}

/* A raw value as a signal: urad (or urad/s) over 65536, in counts, rounded to the nearest. */
static int16_t scaled(uint16_t raw, int32_t zero, int32_t scale, int32_t urad_per_count)
{
    int64_t divisor = (int64_t)65536 * urad_per_count;
    int64_t product = ((int64_t)raw - zero) * scale;
    return saturated((product + (product < 0 ? -divisor : divisor) / 2) / divisor);
}

/* The wiper as a part of its own reference: the supply may drift, the ratio does not. */
static uint16_t ratio(const struct sample *sample)
{
    if (sample->reference == 0)
        return 0;
    uint32_t part = ((uint32_t)sample->pot << 16) / sample->reference;
    return part > 65535 ? 65535 : (uint16_t)part;
}

static uint16_t reference_mv(const struct sample *sample)
{
    return (uint16_t)((uint32_t)sample->reference * sample->supply_mv >> 16);
}

static bool within(uint16_t raw)
{
    return RAW_LEAST <= raw && raw <= RAW_MOST;
}

static bool reference_is_good(const struct node *node, uint16_t millivolts)
{
    int32_t nominal = node->acting.value[REFERENCE_VOLTAGE];
    int32_t off = millivolts - nominal;
    return 20 * (off < 0 ? -off : off) <= nominal; /* 5 % */
}

static uint8_t status(const struct node *node, const struct sample *sample)
{
    unsigned bits = node->counter;
    if (node->calibrated && within(ratio(sample)))
        bits |= POT_OK;
    if (node->calibrated && within(sample->gyro))
        bits |= GYRO_OK;
    if (reference_is_good(node, reference_mv(sample)))
        bits |= VREF_OK;
    if (sample->estop_closed)
        bits |= ESTOP_CLOSED;
    return (uint8_t)bits;
}

static void steer_state(const struct node *node, const struct sample *sample, struct frame *frame)
{
    const int32_t *value = node->acting.value;
    int16_t angle = scaled(ratio(sample), value[POT_ZERO], value[ANGLE_SCALE],
                           URAD_PER_ANGLE_COUNT);
    int16_t rate = scaled(sample->gyro, value[GYRO_ZERO], value[RATE_SCALE], URAD_PER_RATE_COUNT);

    frame->id = STEER_STATE_ID;
    frame->length = 8;
    frame->data[1] = status(node, sample);
    put_u16(frame->data + 2, (uint16_t)angle);
    put_u16(frame->data + 4, (uint16_t)rate);
    put_u16(frame->data + 6, (uint16_t)(sample->time & 0xFFFFu));
    frame->data[0] = crc8_of_frame(STEER_STATE_DATA_ID, frame->data);
}

static void steer_diag(const struct sample *sample, struct frame *frame)
{
    frame->id = STEER_DIAG_ID;
    frame->length = 8;
    put_u16(frame->data, ratio(sample));
    put_u16(frame->data + 2, sample->gyro);
    put_u16(frame->data + 4, reference_mv(sample));
    frame->data[6] = (uint8_t)sample->temperature;
    frame->data[7] = NODE_FIRMWARE;
}

unsigned node_cycle(struct node *node, const struct sample *sample, struct frame frames[2])
{
    unsigned filled = 1;

    node->estop_closed = sample->estop_closed;
    steer_state(node, sample, &frames[0]);
    node->counter = (uint8_t)((node->counter + 1) % COUNTS);
    if (node->until_diag == 0) {
        steer_diag(sample, &frames[1]);
        filled = 2;
        node->until_diag = NODE_DIAG_EVERY;
    }
    node->until_diag--;
    return filled;
}

/* ---- commands ---- */

enum command { READ = 1, WRITE, STORE, FORGET };
enum result { DONE, NOT_IDLE, NO_SUCH_PARAMETER, OUT_OF_RANGE, MEMORY_FAILED, NO_SUCH_COMMAND };

static void answer(struct frame *reply, enum result result, int32_t value)
{
    reply->data[3] = (uint8_t)result;
    put_u32(reply->data + 4, (uint32_t)value);
    reply->data[0] = crc8_of_frame(STEER_REPLY_DATA_ID, reply->data);
}

static enum result write(struct node *node, unsigned parameter, int32_t value)
{
    if (parameter >= PARAMETERS)
        return NO_SUCH_PARAMETER;
    if (!calibration_allows(parameter, value))
        return OUT_OF_RANGE;
    node->pending.value[parameter] = value;
    return DONE;
}

enum request node_command(struct node *node, const struct frame *frame, struct frame *reply,
                          uint8_t block[CALIBRATION_BLOCK])
{
    if (frame->id != STEER_COMMAND_ID || frame->length != 8
        || frame->data[0] != crc8_of_frame(STEER_COMMAND_DATA_ID, frame->data))
        return NOTHING;

    unsigned command = frame->data[1] >> 4, parameter = frame->data[2];
    enum result result = DONE;
    bool known = parameter < PARAMETERS;

    reply->id = STEER_REPLY_ID;
    reply->length = 8;
    reply->data[1] = frame->data[1];
    reply->data[2] = frame->data[2];
    if (command < READ || command > FORGET)
        result = NO_SUCH_COMMAND;
    else if (command == READ)
        result = known ? DONE : NO_SUCH_PARAMETER;
    else if (node->estop_closed)
        /* The angle would jump while the drive may have power. */
        result = NOT_IDLE;
    else if (command == WRITE)
        result = write(node, parameter, get_i32(frame->data + 4));
    else if (command == STORE) {
        calibration_to_block(&node->pending, block);
        return STORE_THEN_ANSWER;
    } else
        node->pending = node->acting;

    const struct calibration *told = command == WRITE ? &node->pending : &node->acting;
    answer(reply, result, known ? told->value[parameter] : 0);
    return ANSWER;
}

void node_stored(struct node *node, bool well, struct frame *reply)
{
    if (well) {
        node->acting = node->pending;
        node->calibrated = true;
    }
    answer(reply, well ? DONE : MEMORY_FAILED, 0);
}
