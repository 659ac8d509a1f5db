/* Frames of the link: version, type, sequence, device microseconds, payload, CRC-32; then COBS and a closing
   zero byte (docs/protocol.md). */
#ifndef FORCEGATE_FIRMWARE_LINK_CODEC_H
#define FORCEGATE_FIRMWARE_LINK_CODEC_H

#include <stdint.h>

#define LINK_VERSION 0x10u /* major 1, minor 0 */
#define LINK_HEADER_SIZE 8u
#define LINK_PAYLOAD_MAX 241u
#define LINK_DECODED_MAX 253u
#define LINK_ENCODED_MAX 255u /* one COBS code byte and the zero more */

typedef struct {
  uint8_t version, type;
  uint16_t sequence;
  uint32_t t_us;
  uint32_t size;
  uint8_t payload[LINK_PAYLOAD_MAX];
} LinkFrame;

/* Writes at most LINK_ENCODED_MAX bytes, returns how many. */
uint32_t link_encode(const LinkFrame* frame, uint8_t* out);

/* `bytes` without the closing zero. 1 = a sound frame. */
int link_decode(const uint8_t* bytes, uint32_t size, LinkFrame* frame);

uint32_t link_crc32(const uint8_t* bytes, uint32_t size);

#endif
