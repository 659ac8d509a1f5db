/* The device's side of the link: bytes in, frames out. A port feeds received bytes and offers a function that
   sends an encoded frame; it returns 0 when the frame had to be dropped, which is counted and reported. */
#ifndef FORCEGATE_FIRMWARE_LINK_DEVICE_H
#define FORCEGATE_FIRMWARE_LINK_DEVICE_H

#include <stdint.h>

#include "compensator.h"
#include "link_codec.h"

typedef int (*LinkSend)(const uint8_t* bytes, uint32_t size);

typedef struct {
  FwCompensator compensator;
  FwCalibration calibration;
  const char* board;
  LinkSend send;
  uint32_t nonce;
  uint16_t sequence;
  uint16_t dropped, bad; /* frames not sent, bytes between zeros that were no frame */
  uint32_t received;
  int overlong;
  uint8_t buffer[LINK_ENCODED_MAX];
} LinkDevice;

/* Starts with a nominal calibration and announces itself with one INFO. */
void link_device_start(LinkDevice* device, const char* board, LinkSend send);
void link_device_byte(LinkDevice* device, uint8_t byte);

#endif
