#include "cycle.h"

#include "board.h"

void cycle_start(struct node *node)
{
    uint8_t block[CALIBRATION_BLOCK];

    board_start();
    board_read_memory(block);
    node_start(node, block);
}

static void serve(struct node *node)
{
    struct frame command, reply;
    uint8_t block[CALIBRATION_BLOCK];

    /* One a cycle: commands, however many, do not delay the next sample. */
    if (!board_receive(&command))
        return;
    switch (node_command(node, &command, &reply, block)) {
    case NOTHING:
        return;
    case STORE_THEN_ANSWER:
        node_stored(node, board_write_memory(block), &reply);
        break;
    case ANSWER:
        break;
    }
    board_send(SLOT_REPLY, &reply);
}

void cycle(struct node *node)
{
    struct sample sample;
    struct frame frames[2];

    board_wait();
    board_sample(&sample);
    unsigned filled = node_cycle(node, &sample, frames);
    board_send(SLOT_STATE, &frames[0]);
    if (filled > 1)
        board_send(SLOT_DIAG, &frames[1]);
    serve(node);
    /* Here alone: a cycle that hangs anywhere ends in a reset. */
    board_feed_watchdog();
}
