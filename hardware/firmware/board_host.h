/* A board that is not there: the tests set what it samples and see what it sends. */
#ifndef BOARD_HOST_H
#define BOARD_HOST_H

#include "board.h"

#define HOST_SENT 64u

struct host_board {
    struct sample sample;
    struct frame sent[HOST_SENT];
    uint32_t sent_count;
    struct frame received;
    bool has_received, memory_fails;
    uint8_t memory[CALIBRATION_BLOCK];
    uint32_t waits, feeds;
};

extern struct host_board host_board;

#endif
