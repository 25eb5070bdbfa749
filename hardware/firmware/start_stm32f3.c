/* Vectors and the start of a Cortex-M4, and what a compiler expects of a library. */

#include <stddef.h>
#include <stdint.h>

extern uint32_t stack_top[], data_source[], data_start[], data_end[], bss_start[], bss_end[];

int main(void);
void SysTick_Handler(void);
void Reset_Handler(void);
void Fault_Handler(void);

void *memcpy(void *to, const void *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        ((volatile uint8_t *)to)[i] = ((const uint8_t *)from)[i];
    return to;
}

void *memset(void *at, int value, size_t count)
{
    for (size_t i = 0; i < count; i++)
        ((volatile uint8_t *)at)[i] = (uint8_t)value;
    return at;
}

void Reset_Handler(void)
{
    const uint32_t *from = data_source;
    for (uint32_t *to = data_start; to < data_end;)
        *to++ = *from++;
    for (uint32_t *to = bss_start; to < bss_end;)
        *to++ = 0;
    main();
    Fault_Handler();
}

/* The watchdog, no longer fed, resets. */
void Fault_Handler(void)
{
    for (;;)
        ;
}

typedef void (*vector)(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    vector vectors[15];
} vectors = {
    stack_top,
    {Reset_Handler, Fault_Handler, Fault_Handler, Fault_Handler, Fault_Handler, Fault_Handler,
     0, 0, 0, 0, Fault_Handler, Fault_Handler, 0, Fault_Handler, SysTick_Handler},
};
