/* The calibration in a page of an STM32F303's flash. */

#include "board.h"
#include "bytes.h"
#include "stm32f303.h"

extern uint8_t calibration_page[]; /* of the linker script: a page of flash of its own */

void board_read_memory(uint8_t block[CALIBRATION_BLOCK])
{
    for (unsigned i = 0; i < CALIBRATION_BLOCK; i++)
        block[i] = calibration_page[i];
}

static bool flash_is_done(void)
{
    while (FLASH_SR & BIT(0))
        ;
    bool well = !(FLASH_SR & (BIT(2) | BIT(4)));
    FLASH_SR = BIT(2) | BIT(4) | BIT(5);
    return well;
}

static bool erase_page(void)
{
    FLASH_CR = BIT(1);
    FLASH_AR = (uint32_t)(uintptr_t)calibration_page;
    FLASH_CR = BIT(1) | BIT(6);
    return flash_is_done();
}

static bool program(const uint8_t block[CALIBRATION_BLOCK])
{
    bool well = true;

    FLASH_CR = BIT(0);
    for (unsigned i = 0; well && i < CALIBRATION_BLOCK; i += 2) {
        REGISTER16((uintptr_t)calibration_page + i) = get_u16(block + i);
        well = flash_is_done();
    }
    return well;
}

bool board_write_memory(const uint8_t block[CALIBRATION_BLOCK])
{
    /* Before, so that the erasing has the watchdog's whole time. */
    board_feed_watchdog();
    if (FLASH_CR & BIT(7)) {
        FLASH_KEYR = 0x45670123u;
        FLASH_KEYR = 0xCDEF89ABu;
    }
    bool well = erase_page() && program(block);
    FLASH_CR = BIT(7);
    for (unsigned i = 0; well && i < CALIBRATION_BLOCK; i++)
        well = *(volatile const uint8_t *)(calibration_page + i) == block[i];
    return well;
}
