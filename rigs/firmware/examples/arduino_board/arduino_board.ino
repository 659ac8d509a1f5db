// Sensor board on an Arduino-class controller: the link of docs/protocol.md with the board's own converter.
// Converts at 1 kHz, answers HELLO, PARAM, RESET, ECHO and TIME, streams SAMPLES after STREAM. The force is the static law
// F = gain U + offset; put your compensation into force_of(). Needs 2 kB of RAM; 460800 baud or more, or batches of 10.
#include <string.h>
#include <stdint.h>
static const uint32_t BAUD = 460800;
static const uint16_t RATE_HZ = 1000;
static const uint8_t ADC_BITS = 10, ADC_PIN = A0;
static const uint8_t BUILD_ID[20] = {0x41, 0x52, 0x44, 0x2d, 0x30, 0x30, 0x31};  // set by your build
static const char BOARD[24] = "arduino", ALGORITHM[32] = "static/1";

struct Calibration { float gain, offset, v_range, b_scale, q_scale; uint8_t adc_bits, id[16]; } __attribute__((packed));
static Calibration cal = {0.5f, 0.0f, 5.0f, 1.0f, 1.0f, ADC_BITS, {'n', 'o', 'm', 'i', 'n', 'a', 'l'}};

static uint8_t rx[256], tx[253];
static uint16_t rx_size = 0, tx_size = 0, sequence = 0, dropped = 0, bad = 0;
static uint32_t nonce = 0;
static bool overlong = false;
// The stream.
static bool running = false;
static uint16_t stream_request = 0, divider = 1, skipped = 0;
static uint8_t batch = 10, batched = 0, samples[32 * 7];
static uint32_t index_next = 0, due_us = 0;

static uint32_t crc32(const uint8_t* p, uint16_t n) {  // IEEE 802.3, bit by bit: no table in RAM
  uint32_t crc = 0xFFFFFFFFul;
  while (n--) {
    crc ^= *p++;
    for (uint8_t i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320ul : 0);
  }
  return ~crc;
}

static void put(const void* data, uint16_t n) { memcpy(tx + tx_size, data, n); tx_size += n; }  // little-endian, as the chip
static void put16(uint16_t v) { put(&v, 2); }
static void put32(uint32_t v) { put(&v, 4); }
static void put8(uint8_t v) { put(&v, 1); }
static void begin_frame(uint8_t type) {
  tx_size = 0;
  put8(0x10); put8(type); put16(sequence++); put32(micros());
}

static void send_frame() {  // CRC, COBS, closing zero; a frame that does not fit is dropped whole and counted
  put32(crc32(tx, tx_size));
  if (Serial.availableForWrite() < (int)tx_size + 2 && running) { ++dropped; return; }
  for (uint16_t from = 0; from <= tx_size;) {
    uint16_t to = from;
    while (to < tx_size && tx[to] != 0) ++to;
    Serial.write((uint8_t)(to - from + 1));
    Serial.write(tx + from, to - from);
    from = to + 1;
  }
  Serial.write((uint8_t)0);
}

static void send_nak(uint16_t request, uint8_t code, uint8_t type) {
  begin_frame(0x84); put16(request); put8(code); put8(type); send_frame();
}
static void send_info(uint16_t request) {
  begin_frame(0x81);
  put16(request); put32(nonce); put8(ADC_BITS); put16(RATE_HZ); put8(32); put32(0);  // no INJECT
  put(BUILD_ID, 20); put(BOARD, 24); put(ALGORITHM, 32);
  send_frame();
}

static bool sound(const Calibration& c) {
  return c.gain >= 0.001f && c.gain <= 100.0f && c.offset >= -50.0f && c.offset <= 50.0f && c.v_range >= 0.1f && c.v_range <= 100.0f &&
         c.b_scale >= 0.01f && c.b_scale <= 100.0f && c.q_scale >= 0.01f && c.q_scale <= 100.0f && c.adc_bits == ADC_BITS;
}

static float force_of(uint16_t code) {
  return cal.gain * ((float)code / ((1u << ADC_BITS) - 1u)) * cal.v_range + cal.offset;
}

static void handle(uint8_t type, uint16_t request, const uint8_t* p, uint16_t n) {
  if (type == 0x01 && n == 4) {  // HELLO
    memcpy(&nonce, p, 4);
    send_info(request);
  } else if (type == 0x04 && n >= 2 && p[0] == 1 && p[1] <= 1) {  // PARAM CAL
    if (p[1] == 1) {
      Calibration asked;
      if (n != 2 + sizeof asked) return send_nak(request, 2, type);
      memcpy(&asked, p + 2, sizeof asked);
      if (!sound(asked)) return send_nak(request, 4, type);
      cal = asked;
    }
    begin_frame(0x85); put16(request); put8(1); put(&cal, sizeof cal); send_frame();
  } else if (type == 0x04 && n >= 2) {
    send_nak(request, 6, type);
  } else if (type == 0x06 && n == 0) {  // RESET
    begin_frame(0x86); put16(request); send_frame();
  } else if (type == 0x07) {  // ECHO
    begin_frame(0x87); put(p, n); send_frame();
  } else if (type == 0x05 && n == 8) {  // TIME
    begin_frame(0x88); put16(request); put(p, 8); send_frame();
  } else if (type == 0x02 && n == 4 && p[3] >= 1 && p[3] <= 32 && (p[1] | p[2] << 8) != 0) {  // STREAM
    running = p[0] != 0;
    divider = p[1] | p[2] << 8; batch = p[3]; stream_request = request;
    skipped = batched = 0; index_next = 0; dropped = bad = 0;
    due_us = micros() + 1000000ul / RATE_HZ;
    begin_frame(0x89); put16(request); put8(running); put16(divider); put8(batch); send_frame();
  } else {
    send_nak(request, type <= 0x07 && type != 0x03 ? 2 : 1, type);
  }
}

static void receive(uint8_t byte) {
  if (byte != 0) {
    if (rx_size < sizeof rx) rx[rx_size++] = byte; else overlong = true;
    return;
  }
  uint16_t n = 0, at = 0;  // COBS in place
  bool good = !overlong;
  while (good && at < rx_size) {
    const uint8_t code = rx[at++];
    if (at + code - 1 > rx_size) good = false;
    for (uint8_t i = 1; good && i < code; ++i) rx[n++] = rx[at++];
    if (good && at < rx_size) rx[n++] = 0;
  }
  const bool empty = rx_size == 0;
  rx_size = 0; overlong = false;
  uint32_t crc = 0;
  if (good && n >= 12) memcpy(&crc, rx + n - 4, 4);
  if (empty) return;
  if (!good || n < 12 || crc != crc32(rx, n - 4)) { ++bad; return; }
  const uint16_t request = rx[2] | rx[3] << 8;
  if (rx[0] >> 4 != 1) return send_nak(request, 3, rx[1]);
  handle(rx[1], request, rx + 8, n - 12);
}

static void convert() {
  const uint16_t code = analogRead(ADC_PIN);
  const float force = force_of(code);
  if (++skipped < divider) return;
  skipped = 0;
  const uint8_t flags = code == 0 || code == (1u << ADC_BITS) - 1u ? 8 : 0;
  uint8_t* s = samples + 7 * batched++;
  memcpy(s, &code, 2); memcpy(s + 2, &force, 4); s[6] = flags;
  if (batched < batch) return;
  begin_frame(0x82);
  put16(stream_request); put32(index_next); put8(batched); put16(dropped); put16(bad); put(samples, 7 * batched);
  send_frame();
  index_next += batched; batched = 0;
}

void setup() { Serial.begin(BAUD); send_info(0); }
void loop() {
  while (Serial.available() > 0) receive((uint8_t)Serial.read());
  if (running && (int32_t)(micros() - due_us) >= 0) { due_us += 1000000ul / RATE_HZ; convert(); }
}
