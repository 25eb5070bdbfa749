/* What a board must do for the node; one file a board: board_stm32f3.c, board_host.c. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>

#include "calibration.h"
#include "node.h"

/* Clocks, converter, CAN at 1 Mbit/s, the timer of 1 ms and the watchdog, which from now on
   resets the processor unless it is fed within 100 ms. */
void board_start(void);

/* Sleeps until the next millisecond of the timer. */
void board_wait(void);

void board_sample(struct sample *sample);

/* Sends a frame. One of the same slot that still waits is replaced: what is old must not be sent
   as if it were new. */
enum slot { SLOT_STATE, SLOT_DIAG, SLOT_REPLY };
void board_send(enum slot slot, const struct frame *frame);

/* A frame that was received; false if there is none. */
bool board_receive(struct frame *frame);

void board_read_memory(uint8_t block[CALIBRATION_BLOCK]);

/* Whether the memory then has it. May take 50 ms. */
bool board_write_memory(const uint8_t block[CALIBRATION_BLOCK]);

void board_feed_watchdog(void);

#endif
