#include "board_host.h"

#include <string.h>

struct host_board host_board;

void board_start(void)
{
    host_board.sent_count = host_board.waits = host_board.feeds = 0;
    host_board.has_received = false;
}

void board_wait(void)
{
    host_board.waits++;
    host_board.sample.time += 100;
}

void board_sample(struct sample *sample)
{
    *sample = host_board.sample;
}

void board_send(enum slot slot, const struct frame *frame)
{
    (void)slot;
    host_board.sent[host_board.sent_count++ % HOST_SENT] = *frame;
}

bool board_receive(struct frame *frame)
{
    if (!host_board.has_received)
        return false;
    *frame = host_board.received;
    host_board.has_received = false;
    return true;
}

void board_read_memory(uint8_t block[CALIBRATION_BLOCK])
{
    memcpy(block, host_board.memory, CALIBRATION_BLOCK);
}

bool board_write_memory(const uint8_t block[CALIBRATION_BLOCK])
{
    if (host_board.memory_fails)
        return false;
    memcpy(host_board.memory, block, CALIBRATION_BLOCK);
    return true;
}

void board_feed_watchdog(void)
{
    host_board.feeds++;
}
