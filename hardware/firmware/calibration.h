/* What turns raw values into radians, and how it is kept without power. */
#ifndef CALIBRATION_H
#define CALIBRATION_H

#include <stdbool.h>
#include <stdint.h>

/* As in the message SteerCommand of steer_node.dbc. */
enum parameter {
    POT_ZERO,          /* straight ahead, 1/65536 of the reference */
    ANGLE_SCALE,       /* urad over the whole reference; negative: mirrored */
    GYRO_ZERO,         /* at rest, 1/65536 of the converter's range */
    RATE_SCALE,        /* urad/s over the whole range; negative: mirrored */
    REFERENCE_VOLTAGE, /* as it should be, mV */
    PARAMETERS
};

struct calibration {
    int32_t value[PARAMETERS];
};

/* The block in the non-volatile memory, little-endian: magic, version, size of the values, the
   values, CRC-32 of all before it. */
#define CALIBRATION_MAGIC 0x4C414342u /* "BCAL" */
#define CALIBRATION_VERSION 1u
#define CALIBRATION_BLOCK (8u + 4u * PARAMETERS + 4u)

/* Whether a parameter may have a value; false too for a parameter that there is not. */
bool calibration_allows(unsigned parameter, int32_t value);

void calibration_to_block(const struct calibration *calibration, uint8_t block[CALIBRATION_BLOCK]);

/* False, and nothing changed, unless the block is whole and all its values are allowed. */
bool calibration_from_block(struct calibration *calibration,
                            const uint8_t block[CALIBRATION_BLOCK]);

#endif
