/* Cyclic redundancy checks, bit by bit: a node has time, and no table can be damaged. */
#ifndef CRC_H
#define CRC_H

#include <stdint.h>

/* CRC-8 SAE J1850: polynomial 0x1D, initial value and final XOR 0xFF; "123456789" gives 0x4B. */
uint8_t crc8(const uint8_t *data, unsigned length);

/* The same over a message's data id and bytes 1 to 7 of its frame. */
uint8_t crc8_of_frame(uint8_t data_id, const uint8_t frame[8]);

/* CRC-32 as Ethernet has it: reflected polynomial 0xEDB88320; "123456789" gives 0xCBF43926. */
uint32_t crc32(const uint8_t *data, unsigned length);

#endif
