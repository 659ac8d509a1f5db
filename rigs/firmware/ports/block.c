/* Block port: the host streams request blocks into the file "request" and takes answers from "answer" (both
   may be named pipes). Layout in docs/protocol.md, section "Blocks". A request header with the magic FGBT asks
   for one sample at each tick of a 1 kHz clock and for what every sample cost (section "Ticks"). */
#include <stdint.h>
#include <string.h>

#include "compensator.h"
#include "identity.h"
#include "ports/semihost.h"
#include "ports/stack.h"
#include "ports/tick.h"

#ifndef FW_BOARD
#error "define FW_BOARD"
#endif

/* Read by the harness from the file, to know how to run the image. */
__attribute__((section(".forcegate"), used)) static const char kPort[] =
    "forcegate-port:block:" FW_BOARD "\0forcegate-build:" FW_BUILD_ID "\0forcegate-tick:1";

#define BLOCK_MAX 4096u
#define MAGIC(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

typedef struct {
  float gain_N_per_V, offset_N, v_range_V, b_scale, q_scale;
  uint32_t adc_bits;
  char id[16];
} BlockCalibration;

typedef struct {
  uint32_t magic, version, nonce, rate_Hz;
  BlockCalibration calibration;
} RequestHeader;

typedef struct {
  uint32_t magic, version, nonce, status, rate_Hz;
  BlockCalibration calibration;
  char board[FW_BOARD_SIZE];
  char build_id[FW_BUILD_ID_SIZE];
  char algorithm_id[FW_ALGORITHM_SIZE];
} AnswerHeader;

typedef struct {
  uint32_t magic, first_index, n, status;
} BlockHead;

_Static_assert(sizeof(RequestHeader) == 56, "layout");
_Static_assert(sizeof(AnswerHeader) == 156, "layout");

static FwCompensator compensator;
static uint16_t adc[BLOCK_MAX];
static struct {
  BlockHead head;
  uint8_t data[BLOCK_MAX * 9u];
} answer;
static int ticking;

static uint32_t greet(int32_t out, const RequestHeader* request) {
  const BlockCalibration* in = &request->calibration;
  FwCalibration calibration = {.gain_N_per_V = in->gain_N_per_V,
                               .offset_N = in->offset_N,
                               .v_range_V = in->v_range_V,
                               .b_scale = in->b_scale,
                               .q_scale = in->q_scale,
                               .adc_bits = in->adc_bits <= 16u ? (uint8_t)in->adc_bits : 0};
  memcpy(calibration.id, in->id, sizeof calibration.id);
  static AnswerHeader reply;
  reply.magic = MAGIC('F', 'G', 'B', 'A');
  reply.version = FW_PROTOCOL_MAJOR << 8 | FW_PROTOCOL_MINOR;
  reply.nonce = request->nonce;
  reply.rate_Hz = FW_RATE_HZ;
  memcpy(reply.board, FW_BOARD, sizeof FW_BOARD - 1);
  memcpy(reply.build_id, FW_BUILD_ID, sizeof reply.build_id);
  memcpy(reply.algorithm_id, FW_ALGORITHM_ID, sizeof FW_ALGORITHM_ID - 1);
  ticking = request->magic == MAGIC('F', 'G', 'B', 'T');
  if ((request->magic != MAGIC('F', 'G', 'B', 'Q') && !ticking) || request->version >> 8 != FW_PROTOCOL_MAJOR) {
    reply.status = 2;
  } else if (request->rate_Hz != FW_RATE_HZ || !fw_calibration_is_valid(&calibration)) {
    reply.status = 1;
  } else {
    reply.calibration = *in;
    fw_compensator_reset(&compensator, &calibration);
  }
  if (!semihost_write_all(out, &reply, sizeof reply)) return 3;
  return reply.status;
}

/* n x force, n x flags, n x cost in ticks of the clock */
static void step_at_ticks(uint32_t n) {
  uint8_t* flags = answer.data + 4u * n;
  uint8_t* costs = answer.data + 5u * n;
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t begin = tick_wait();
    const float force_N = fw_compensator_step(&compensator, adc[i], &flags[i]);
    const uint32_t cost = tick_since(begin);
    memcpy(answer.data + 4u * i, &force_N, sizeof force_N);
    memcpy(costs + 4u * i, &cost, sizeof cost);
  }
}

static int finish(int32_t out) {
  if (!ticking) return 0;
  answer.head.magic = MAGIC('F', 'G', 'B', 'E');
  answer.head.first_index = tick_late();
  answer.head.n = stack_used_bytes();
  answer.head.status = 0;
  return semihost_write_all(out, &answer, sizeof answer.head) ? 0 : 6;
}

static int serve(int32_t in, int32_t out) {
  BlockHead head;
  if (ticking) tick_start();
  while (semihost_read_all(in, &head, sizeof head)) {
    if (head.magic != MAGIC('F', 'G', 'B', 'D') || head.n > BLOCK_MAX) return 4;
    if (head.n == 0) return finish(out);
    if (!semihost_read_all(in, adc, 2u * head.n)) return 5;
    answer.head = head;
    answer.head.magic = MAGIC('F', 'G', 'B', 'R');
    answer.head.status = head.first_index == compensator.index ? 0 : 1;
    uint8_t* flags = answer.data + 4u * head.n;
    if (ticking) {
      step_at_ticks(head.n);
    } else {
      for (uint32_t i = 0; i < head.n; ++i) {
        const float force_N = fw_compensator_step(&compensator, adc[i], &flags[i]);
        memcpy(answer.data + 4u * i, &force_N, sizeof force_N);
      }
    }
    if (!semihost_write_all(out, &answer, sizeof answer.head + (ticking ? 9u : 5u) * head.n)) return 6;
  }
  return 0;
}

int main(void) {
  const int32_t in = semihost_open("request", SEMIHOST_READ_BINARY);
  const int32_t out = semihost_open("answer", SEMIHOST_WRITE_BINARY);
  if (in < 0 || out < 0) return 7;
  RequestHeader request;
  if (!semihost_read_all(in, &request, sizeof request)) return 8;
  const uint32_t status = greet(out, &request);
  return status != 0 ? (int)status : serve(in, out);
}

void port_exit(int status) { semihost_exit(status); }
