#include "link_codec.h"

#include <string.h>

uint32_t link_crc32(const uint8_t* bytes, uint32_t size) {
  static const uint32_t kNibble[16] = {
      0x00000000u, 0x1db71064u, 0x3b6e20c8u, 0x26d930acu, 0x76dc4190u, 0x6b6b51f4u, 0x4db26158u, 0x5005713cu,
      0xedb88320u, 0xf00f9344u, 0xd6d6a3e8u, 0xcb61b38cu, 0x9b64c2b0u, 0x86d3d2d4u, 0xa00ae278u, 0xbdbdf21cu};
  uint32_t crc = 0xffffffffu;
  for (uint32_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    crc = (crc >> 4) ^ kNibble[crc & 15u];
    crc = (crc >> 4) ^ kNibble[crc & 15u];
  }
  return ~crc;
}

static void put16(uint8_t* p, uint32_t v) {
  p[0] = (uint8_t)v;
  p[1] = (uint8_t)(v >> 8);
}

static void put32(uint8_t* p, uint32_t v) {
  put16(p, v & 0xffffu);
  put16(p + 2, v >> 16);
}

static uint32_t get16(const uint8_t* p) { return (uint32_t)p[0] | (uint32_t)p[1] << 8; }
static uint32_t get32(const uint8_t* p) { return get16(p) | get16(p + 2) << 16; }

uint32_t link_encode(const LinkFrame* frame, uint8_t* out) {
  uint8_t raw[LINK_DECODED_MAX];
  raw[0] = frame->version;
  raw[1] = frame->type;
  put16(raw + 2, frame->sequence);
  put32(raw + 4, frame->t_us);
  memcpy(raw + LINK_HEADER_SIZE, frame->payload, frame->size);
  uint32_t size = LINK_HEADER_SIZE + frame->size;
  put32(raw + size, link_crc32(raw, size));
  size += 4u;
  uint32_t code_at = 0, n = 1;
  for (uint32_t i = 0; i < size; ++i) {
    if (raw[i] == 0) {
      out[code_at] = (uint8_t)(n - code_at);
      code_at = n++;
    } else {
      out[n++] = raw[i];
    }
  }
  out[code_at] = (uint8_t)(n - code_at); /* at most 254: no block of the frame is ever split */
  out[n++] = 0;
  return n;
}

int link_decode(const uint8_t* bytes, uint32_t size, LinkFrame* frame) {
  uint8_t raw[LINK_DECODED_MAX];
  uint32_t n = 0, i = 0;
  if (size > LINK_ENCODED_MAX - 1u) return 0;
  while (i < size) {
    const uint32_t code = bytes[i++];
    if (code == 0 || code - 1u > size - i || n + code - 1u > LINK_DECODED_MAX) return 0;
    for (uint32_t k = 1; k < code; ++k) {
      if (bytes[i] == 0) return 0;
      raw[n++] = bytes[i++];
    }
    if (i < size) {
      if (n == LINK_DECODED_MAX) return 0;
      raw[n++] = 0;
    }
  }
  if (n < LINK_HEADER_SIZE + 4u || get32(raw + n - 4u) != link_crc32(raw, n - 4u)) return 0;
  frame->version = raw[0];
  frame->type = raw[1];
  frame->sequence = (uint16_t)get16(raw + 2);
  frame->t_us = get32(raw + 4);
  frame->size = n - LINK_HEADER_SIZE - 4u;
  memcpy(frame->payload, raw + LINK_HEADER_SIZE, frame->size);
  return 1;
}
