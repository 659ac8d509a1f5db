#include "link_device.h"

#include <string.h>

#include "identity.h"

enum {
  HELLO = 0x01,
  INJECT = 0x03,
  PARAM = 0x04,
  TIME = 0x05,
  RESET = 0x06,
  ECHO = 0x07,
  INFO = 0x81,
  SAMPLES = 0x82,
  NAK = 0x84,
  PARAM_VALUE = 0x85,
  RESET_DONE = 0x86,
  ECHO_REPLY = 0x87,
  TIME_REPLY = 0x88
};
enum {
  NAK_UNKNOWN_TYPE = 1,
  NAK_MALFORMED = 2,
  NAK_VERSION = 3,
  NAK_CALIBRATION = 4,
  NAK_INDEX = 5,
  NAK_PARAMETER = 6
};
enum { PARAM_CAL = 1, PARAM_GET = 0, PARAM_SET = 1 };
enum { BATCH_MAX = 32, CAL_SIZE = 37, CAPABILITIES = 1 /* INJECT */ };

static const char kBuildId[] = FW_BUILD_ID;

static uint32_t get16(const uint8_t* p) { return (uint32_t)p[0] | (uint32_t)p[1] << 8; }
static uint32_t get32(const uint8_t* p) { return get16(p) | get16(p + 2) << 16; }
static uint8_t* put8(uint8_t* p, uint32_t v) {
  *p = (uint8_t)v;
  return p + 1;
}
static uint8_t* put16(uint8_t* p, uint32_t v) { return put8(put8(p, v), v >> 8); }
static uint8_t* put32(uint8_t* p, uint32_t v) { return put16(put16(p, v), v >> 16); }
static uint8_t* put_float(uint8_t* p, float v) {
  uint32_t bits;
  memcpy(&bits, &v, sizeof bits);
  return put32(p, bits);
}
static float get_float(const uint8_t* p) {
  const uint32_t bits = get32(p);
  float v;
  memcpy(&v, &bits, sizeof v);
  return v;
}

static void transmit(LinkDevice* d, uint8_t type, LinkFrame* frame, const uint8_t* end) {
  uint8_t encoded[LINK_ENCODED_MAX];
  frame->version = LINK_VERSION;
  frame->type = type;
  frame->sequence = d->sequence++;
  frame->t_us = d->compensator.index * (1000000u / FW_RATE_HZ); /* the injected samples are the clock */
  frame->size = (uint32_t)(end - frame->payload);
  if (!d->send(encoded, link_encode(frame, encoded))) ++d->dropped;
}

static void refuse(LinkDevice* d, const LinkFrame* request, uint8_t code) {
  LinkFrame reply;
  uint8_t* p = put16(reply.payload, request->sequence);
  p = put8(put8(p, code), request->type);
  transmit(d, NAK, &reply, p);
}

static uint32_t hex_digit(char c) { return (uint32_t)(c <= '9' ? c - '0' : c - 'a' + 10); }

static void inform(LinkDevice* d, uint16_t request_sequence) {
  LinkFrame reply;
  uint8_t* p = put16(reply.payload, request_sequence);
  p = put32(p, d->nonce);
  p = put8(p, d->calibration.adc_bits);
  p = put16(p, FW_RATE_HZ);
  p = put8(p, BATCH_MAX);
  p = put32(p, CAPABILITIES);
  for (int i = 0; i < 20; ++i) p = put8(p, hex_digit(kBuildId[2 * i]) << 4 | hex_digit(kBuildId[2 * i + 1]));
  memset(p, 0, FW_BOARD_SIZE + FW_ALGORITHM_SIZE);
  memcpy(p, d->board, strlen(d->board));
  memcpy(p + FW_BOARD_SIZE, FW_ALGORITHM_ID, sizeof FW_ALGORITHM_ID - 1);
  transmit(d, INFO, &reply, p + FW_BOARD_SIZE + FW_ALGORITHM_SIZE);
}

static void parameter(LinkDevice* d, const LinkFrame* request) {
  const uint8_t* in = request->payload;
  if (request->size < 2u || in[0] != PARAM_CAL || in[1] > PARAM_SET) {
    refuse(d, request, NAK_PARAMETER);
    return;
  }
  if (in[1] == PARAM_SET) {
    if (request->size != 2u + CAL_SIZE) {
      refuse(d, request, NAK_MALFORMED);
      return;
    }
    FwCalibration calibration;
    calibration.gain_N_per_V = get_float(in + 2);
    calibration.offset_N = get_float(in + 6);
    calibration.v_range_V = get_float(in + 10);
    calibration.b_scale = get_float(in + 14);
    calibration.q_scale = get_float(in + 18);
    calibration.adc_bits = in[22];
    memcpy(calibration.id, in + 23, sizeof calibration.id);
    if (!fw_calibration_is_valid(&calibration)) {
      refuse(d, request, NAK_CALIBRATION);
      return;
    }
    d->calibration = calibration;
    fw_compensator_reset(&d->compensator, &d->calibration);
  }
  LinkFrame reply;
  uint8_t* p = put8(put16(reply.payload, request->sequence), PARAM_CAL);
  p = put_float(p, d->calibration.gain_N_per_V);
  p = put_float(p, d->calibration.offset_N);
  p = put_float(p, d->calibration.v_range_V);
  p = put_float(p, d->calibration.b_scale);
  p = put_float(p, d->calibration.q_scale);
  p = put8(p, d->calibration.adc_bits);
  memcpy(p, d->calibration.id, sizeof d->calibration.id);
  transmit(d, PARAM_VALUE, &reply, p + sizeof d->calibration.id);
}

static void inject(LinkDevice* d, const LinkFrame* request) {
  const uint8_t* in = request->payload;
  if (request->size < 5u || in[4] == 0 || in[4] > BATCH_MAX || request->size != 5u + 2u * in[4]) {
    refuse(d, request, NAK_MALFORMED);
    return;
  }
  const uint32_t first_index = get32(in), n = in[4];
  if (first_index != d->compensator.index) {
    refuse(d, request, NAK_INDEX);
    return;
  }
  LinkFrame reply;
  uint8_t* p = put16(reply.payload, request->sequence);
  p = put16(put16(put8(put32(p, first_index), n), d->dropped), d->bad);
  for (uint32_t i = 0; i < n; ++i) {
    uint8_t flags;
    const uint16_t code = (uint16_t)get16(in + 5 + 2u * i);
    const float force_N = fw_compensator_step(&d->compensator, code, &flags);
    p = put8(put_float(put16(p, code), force_N), flags);
  }
  transmit(d, SAMPLES, &reply, p);
}

static void handle(LinkDevice* d, const LinkFrame* request) {
  LinkFrame reply;
  if (request->version >> 4 != LINK_VERSION >> 4) {
    refuse(d, request, NAK_VERSION);
    return;
  }
  switch (request->type) {
    case HELLO:
      if (request->size != 4u) {
        refuse(d, request, NAK_MALFORMED);
        return;
      }
      d->nonce = get32(request->payload);
      inform(d, request->sequence);
      return;
    case PARAM: parameter(d, request); return;
    case INJECT: inject(d, request); return;
    case RESET:
      fw_compensator_reset(&d->compensator, &d->calibration);
      d->dropped = d->bad = 0;
      transmit(d, RESET_DONE, &reply, put16(reply.payload, request->sequence));
      return;
    case ECHO:
      memcpy(reply.payload, request->payload, request->size);
      transmit(d, ECHO_REPLY, &reply, reply.payload + request->size);
      return;
    case TIME: {
      if (request->size != 8u) {
        refuse(d, request, NAK_MALFORMED);
        return;
      }
      uint8_t* p = put16(reply.payload, request->sequence);
      memcpy(p, request->payload, 8u);
      transmit(d, TIME_REPLY, &reply, p + 8);
      return;
    }
    default: refuse(d, request, NAK_UNKNOWN_TYPE);
  }
}

void link_device_start(LinkDevice* d, const char* board, LinkSend send) {
  static const FwCalibration kNominal = {0.5f, 0.0f, 10.0f, 1.0f, 1.0f, 16, "nominal"};
  memset(d, 0, sizeof *d);
  d->board = board;
  d->send = send;
  d->calibration = kNominal;
  fw_compensator_reset(&d->compensator, &d->calibration);
  inform(d, 0);
}

void link_device_byte(LinkDevice* d, uint8_t byte) {
  if (byte != 0) {
    if (d->received < sizeof d->buffer) {
      d->buffer[d->received++] = byte;
    } else {
      d->overlong = 1;
    }
    return;
  }
  if (d->received > 0) {
    LinkFrame frame;
    if (!d->overlong && link_decode(d->buffer, d->received, &frame)) {
      handle(d, &frame);
    } else {
      ++d->bad;
    }
  }
  d->received = 0;
  d->overlong = 0;
}
