/* The steering sensor node: what was sampled becomes the frames of steer_node.dbc.

   No hardware in here, no floating point and no memory from a heap; the board's part is in
   board.h. Right is positive. */
#ifndef NODE_H
#define NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "calibration.h"

#define NODE_FIRMWARE 1u
#define NODE_DIAG_EVERY 20u /* cycles of 1 ms */

enum {
    STEER_STATE_ID = 0x110,
    STEER_DIAG_ID = 0x111,
    STEER_COMMAND_ID = 0x112,
    STEER_REPLY_ID = 0x113
};

struct frame {
    uint16_t id;
    uint8_t length;
    uint8_t data[8];
};

/* Raw values are parts of the converter's range, 0 to 65535, averaged around `time`. */
struct sample {
    uint16_t pot;       /* the wiper */
    uint16_t reference; /* the voltage across the potentiometer */
    uint16_t gyro;
    uint16_t supply_mv; /* what the converter's whole range is */
    int8_t temperature; /* deg C */
    bool estop_closed;
    uint32_t time;      /* free-running, 10 us */
};

struct node {
    struct calibration acting, pending;
    bool calibrated, estop_closed;
    uint8_t counter, until_diag;
};

/* Starts with the block that the memory has. If that is not whole, the node sends, but says that
   neither potentiometer nor gyro is good. */
void node_start(struct node *node, const uint8_t block[CALIBRATION_BLOCK]);

/* One cycle: fills SteerState, and in every 20th cycle SteerDiag; gives how many. */
unsigned node_cycle(struct node *node, const struct sample *sample, struct frame frames[2]);

/* What a command needs besides an answer. */
enum request { NOTHING, ANSWER, STORE_THEN_ANSWER };

/* Takes a frame that was received. For STORE_THEN_ANSWER the caller writes `block` to the memory
   and tells node_stored how that went; in both cases `reply` is then to be sent. */
enum request node_command(struct node *node, const struct frame *frame, struct frame *reply,
                          uint8_t block[CALIBRATION_BLOCK]);

/* After storing: if it went well, what was written acts from now on. */
void node_stored(struct node *node, bool well, struct frame *reply);

#endif
