#include "calibration.h"

#include "bytes.h"
#include "crc.h"

static const struct {
    int32_t least, most; /* of the magnitude */
    bool may_be_negative;
} allowed[PARAMETERS] = {
    [POT_ZERO] = {0, 65535, false},
    [ANGLE_SCALE] = {100000, 50000000, true},    /* 0.1 to 50 rad */
    [GYRO_ZERO] = {0, 65535, false},
    [RATE_SCALE] = {100000, 2000000000, true},   /* 0.1 to 2000 rad/s */
    [REFERENCE_VOLTAGE] = {500, 5500, false},
};

bool calibration_allows(unsigned parameter, int32_t value)
{
    if (parameter >= PARAMETERS || value == INT32_MIN)
        return false;
    if (value < 0 && !allowed[parameter].may_be_negative)
        return false;
    int32_t magnitude = value < 0 ? -value : value;
    return allowed[parameter].least <= magnitude && magnitude <= allowed[parameter].most;
}

void calibration_to_block(const struct calibration *calibration, uint8_t block[CALIBRATION_BLOCK])
{
    put_u32(block, CALIBRATION_MAGIC);
    put_u16(block + 4, CALIBRATION_VERSION);
    put_u16(block + 6, 4u * PARAMETERS);
    for (unsigned i = 0; i < PARAMETERS; i++)
        put_u32(block + 8 + 4 * i, (uint32_t)calibration->value[i]);
    put_u32(block + CALIBRATION_BLOCK - 4, crc32(block, CALIBRATION_BLOCK - 4));
}

bool calibration_from_block(struct calibration *calibration,
                            const uint8_t block[CALIBRATION_BLOCK])
{
    struct calibration found;

    if (get_u32(block) != CALIBRATION_MAGIC || get_u16(block + 4) != CALIBRATION_VERSION
        || get_u16(block + 6) != 4u * PARAMETERS
        || get_u32(block + CALIBRATION_BLOCK - 4) != crc32(block, CALIBRATION_BLOCK - 4))
        return false;
    for (unsigned i = 0; i < PARAMETERS; i++) {
        found.value[i] = get_i32(block + 8 + 4 * i);
        if (!calibration_allows(i, found.value[i]))
            return false;
    }
    *calibration = found;
    return true;
}
