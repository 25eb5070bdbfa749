/* The millisecond of the node, with the board in it. */
#ifndef CYCLE_H
#define CYCLE_H

#include "node.h"

void cycle_start(struct node *node);
void cycle(struct node *node);

#endif
