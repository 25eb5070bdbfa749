#include "crc.h"

static uint8_t crc8_byte(uint8_t crc, uint8_t byte)
{
    unsigned bits = crc ^ byte;
    for (int i = 0; i < 8; i++)
        bits = (bits & 0x80u) ? (bits << 1) ^ 0x11Du : bits << 1;
    return (uint8_t)bits;
}

uint8_t crc8(const uint8_t *data, unsigned length)
{
    uint8_t crc = 0xFF;
    for (unsigned i = 0; i < length; i++)
        crc = crc8_byte(crc, data[i]);
    return crc ^ 0xFF;
}

uint8_t crc8_of_frame(uint8_t data_id, const uint8_t frame[8])
{
    uint8_t crc = crc8_byte(0xFF, data_id);
    for (unsigned i = 1; i < 8; i++)
        crc = crc8_byte(crc, frame[i]);
    return crc ^ 0xFF;
}

uint32_t crc32(const uint8_t *data, unsigned length)
{
    uint32_t crc = 0xFFFFFFFFu;
    for (unsigned i = 0; i < length; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = (crc & 1u) ? (crc >> 1) ^ 0xEDB88320u : crc >> 1;
    }
    return ~crc;
}
