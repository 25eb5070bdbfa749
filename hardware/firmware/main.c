#include "cycle.h"

int main(void)
{
    static struct node node;

    cycle_start(&node);
    for (;;)
        cycle(&node);
}
