/* The node on an STM32F303, bare registers; pins as on a NUCLEO-F303RE with a CAN transceiver.

   PA0 (A0)  the potentiometer's wiper, with 1 Mohm to ground: an open wiper reads 0
   PA1 (A1)  the voltage across the potentiometer, which is the board's 3.3 V
   PC1 (A4)  the angular-rate sensor's output
   PA8 (D7)  the emergency stop's auxiliary contact to 3.3 V: a broken wire reads as open
   PB8, PB9  CAN receive and transmit

   The one interrupt counts milliseconds and does nothing else. No floating point anywhere.
   The calibration's page of flash is in memory_stm32f3.c. */

#include "board.h"
#include "bytes.h"
#include "stm32f303.h"

enum { POT = 1, REFERENCE = 2, GYRO = 7, TEMPERATURE = 16, INTERNAL_REFERENCE = 18 };
enum { ROUNDS = 16 }; /* of 12 bits each: their sum has 16 */

static volatile uint32_t milliseconds;
static uint32_t waited_for;

void SysTick_Handler(void);
void SysTick_Handler(void)
{
    milliseconds++;
}

/* ---- start ---- */

/* 72 MHz from the 8 MHz that the programmer's half of the board gives: CAN at 1 Mbit/s needs a
   crystal's accuracy. Without it this never returns, and the node is silent. */
static void start_clocks(void)
{
    RCC_CR |= BIT(18) | BIT(16);
    while (!(RCC_CR & BIT(17)))
        ;
    FLASH_ACR = BIT(4) | 2u;
    RCC_CFGR = 7u << 18 | BIT(16) | 4u << 8; /* times 9; half of it for the slow bus */
    RCC_CR |= BIT(24);
    while (!(RCC_CR & BIT(25)))
        ;
    RCC_CFGR |= 2u;
    while ((RCC_CFGR & 0xCu) != 8u)
        ;
    RCC_AHBENR |= BIT(28) | BIT(19) | BIT(18) | BIT(17);
    RCC_APB1ENR |= BIT(25) | BIT(0);
}

static void start_pins(void)
{
    GPIOA_MODER |= 0xFu;                                       /* PA0, PA1 analogue */
    GPIOA_MODER &= ~(3u << 16);                                /* PA8 input, */
    GPIOA_PUPDR = (GPIOA_PUPDR & ~(3u << 16)) | 2u << 16;      /* pulled down */
    GPIOC_MODER |= 3u << 2;                                    /* PC1 analogue */
    GPIOB_MODER = (GPIOB_MODER & ~(0xFu << 16)) | 0xAu << 16;  /* PB8, PB9 */
    GPIOB_OSPEEDR |= 3u << 18;
    GPIOB_AFRH = (GPIOB_AFRH & ~0xFFu) | 0x99u;                /* are CAN's */
}

/* 10 us free-running; 1 ms by interrupt. */
static void start_timers(void)
{
    TIM2_PSC = 720u - 1u;
    TIM2_ARR = 0xFFFFFFFFu;
    TIM2_EGR = 1u;
    TIM2_CR1 = 1u;
    SYST_RVR = 72000u - 1u;
    SYST_CVR = 0u;
    SYST_CSR = 7u;
}

static void wait_10us(uint32_t count)
{
    uint32_t from = TIM2_CNT;
    while (TIM2_CNT - from < count)
        ;
}

static void start_converter(void)
{
    ADC12_CCR = 3u << 16 | BIT(22) | BIT(23); /* 18 MHz; internal reference, temperature */
    ADC1_CR = 0u;
    ADC1_CR = BIT(28);
    wait_10us(3);
    ADC1_CR |= BIT(31);
    while (ADC1_CR & BIT(31))
        ;
    wait_10us(1);
    ADC1_CR |= BIT(0);
    while (!(ADC1_ISR & BIT(0)))
        ;
    /* 61.5 cycles, 3.4 us, for all: what the internal sensors need. */
    ADC1_SMPR1 = 5u << 3 * POT | 5u << 3 * REFERENCE | 5u << 3 * GYRO;
    ADC1_SMPR2 = 5u << 3 * (TEMPERATURE - 10) | 5u << 3 * (INTERNAL_REFERENCE - 10);
}

/* 1 Mbit/s of 36 MHz: 18 quanta, sampled at 78 %. Comes back by itself after bus-off. */
static void start_can(void)
{
    CAN_MCR = BIT(6) | BIT(0);
    while (!(CAN_MSR & BIT(0)) || (CAN_MSR & BIT(1)))
        ;
    CAN_BTR = BIT(24) | 3u << 20 | 12u << 16 | 1u;
    CAN_FMR |= 1u;
    CAN_FA1R = 0u;
    CAN_FM1R = 0u;
    CAN_FS1R = 1u;
    CAN_FFA1R = 0u;
    CAN_F0R1 = (uint32_t)STEER_COMMAND_ID << 21;
    CAN_F0R2 = 0x7FFu << 21 | BIT(2) | BIT(1);
    CAN_FA1R = 1u;
    CAN_FMR &= ~1u;
    CAN_MCR &= ~BIT(0);
    /* Not waited for: on a bus that is shorted it would take for ever. */
}

/* 40 kHz by 16, 250 counts: 100 ms, longer than the flash takes to erase a page. */
static void start_watchdog(void)
{
    IWDG_KR = 0xCCCCu;
    IWDG_KR = 0x5555u;
    IWDG_PR = 2u;
    IWDG_RLR = 250u;
    while (IWDG_SR)
        ;
    IWDG_KR = 0xAAAAu;
}

void board_start(void)
{
    /* First, so that a crystal that does not start ends in a reset and not in silence for ever. */
    start_watchdog();
    start_clocks();
    start_pins();
    start_timers();
    start_converter();
    start_can();
}

/* ---- time ---- */

void board_wait(void)
{
    for (;;) {
        /* Masked, an interrupt still wakes, but cannot slip in between look and sleep. */
        __asm volatile("cpsid i" ::: "memory");
        uint32_t now = milliseconds;
        if (now != waited_for) {
            __asm volatile("cpsie i" ::: "memory");
            waited_for = now;
            return;
        }
        __asm volatile("wfi");
        __asm volatile("cpsie i" ::: "memory");
    }
}

void board_feed_watchdog(void)
{
    IWDG_KR = 0xAAAAu;
}

/* ---- converter ---- */

static uint16_t convert(unsigned channel)
{
    ADC1_SQR1 = channel << 6;
    ADC1_CR |= BIT(2);
    while (!(ADC1_ISR & BIT(2)))
        ;
    return (uint16_t)ADC1_DR;
}

static uint16_t supply_mv(void)
{
    uint32_t raw = convert(INTERNAL_REFERENCE);
    uint32_t millivolts = raw ? 3300u * VREFINT_CAL / raw : 0;
    return millivolts > 65535 ? 65535 : (uint16_t)millivolts;
}

static int8_t temperature(uint16_t supply)
{
    int32_t at_3v3 = (int32_t)((uint32_t)convert(TEMPERATURE) * supply / 3300u);
    int32_t low = TS_CAL1, high = TS_CAL2;
    if (high == low)
        return -128;
    int32_t celsius = 30 + (at_3v3 - low) * 80 / (high - low);
    return (int8_t)(celsius > 127 ? 127 : celsius < -128 ? -128 : celsius);
}

/* 50 conversions of 4.1 us: 0.2 ms. */
void board_sample(struct sample *sample)
{
    uint32_t pot = 0, reference = 0, gyro = 0;

    for (int round = 0; round < ROUNDS; round++) {
        if (round == ROUNDS / 2)
            sample->time = TIM2_CNT;
        pot += convert(POT);
        reference += convert(REFERENCE);
        gyro += convert(GYRO);
    }
    sample->pot = (uint16_t)pot;
    sample->reference = (uint16_t)reference;
    sample->gyro = (uint16_t)gyro;
    sample->supply_mv = supply_mv();
    sample->temperature = temperature(sample->supply_mv);
    sample->estop_closed = (GPIOA_IDR & BIT(8)) != 0;
}

/* ---- CAN ---- */

void board_send(enum slot slot, const struct frame *frame)
{
    uint32_t empty = BIT(26 + (unsigned)slot);

    if (!(CAN_TSR & empty)) {
        CAN_TSR = BIT(7 + 8 * (unsigned)slot);
        /* One that is on the wire is finished, which takes 0.14 ms at most. */
        for (uint32_t from = TIM2_CNT; !(CAN_TSR & empty);)
            if (TIM2_CNT - from > 20)
                return;
    }
    CAN_TIR(slot) = (uint32_t)frame->id << 21;
    CAN_TDTR(slot) = frame->length;
    CAN_TDLR(slot) = get_u32(frame->data);
    CAN_TDHR(slot) = get_u32(frame->data + 4);
    CAN_TIR(slot) |= 1u;
}

bool board_receive(struct frame *frame)
{
    if (!(CAN_RF0R & 3u))
        return false;
    frame->id = (uint16_t)(CAN_RIR >> 21);
    frame->length = (uint8_t)(CAN_RDTR & 0xFu);
    put_u32(frame->data, CAN_RDLR);
    put_u32(frame->data + 4, CAN_RDHR);
    CAN_RF0R = BIT(5);
    return true;
}
