#include "ports/semihost.h"

#include <string.h>

static uint32_t call(uint32_t operation, const void* block) {
  register uint32_t r0 __asm__("r0") = operation;
  register const void* r1 __asm__("r1") = block;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

int32_t semihost_open(const char* path, uint32_t mode) {
  const uint32_t block[3] = {(uint32_t)path, mode, (uint32_t)strlen(path)};
  return (int32_t)call(0x01, block);
}

/* SYS_READ and SYS_WRITE answer with the number of bytes that were not moved; a pipe moves part of them. */
int semihost_read_all(int32_t handle, void* data, uint32_t size) {
  uint8_t* at = data;
  while (size > 0) {
    const uint32_t block[3] = {(uint32_t)handle, (uint32_t)at, size};
    const uint32_t left = call(0x06, block);
    if (left >= size) return 0;
    at += size - left;
    size = left;
  }
  return 1;
}

int semihost_write_all(int32_t handle, const void* data, uint32_t size) {
  const uint8_t* at = data;
  while (size > 0) {
    const uint32_t block[3] = {(uint32_t)handle, (uint32_t)at, size};
    const uint32_t left = call(0x05, block);
    if (left >= size) return 0;
    at += size - left;
    size = left;
  }
  return 1;
}

void semihost_exit(int status) {
  const uint32_t block[2] = {0x20026u /* ADP_Stopped_ApplicationExit */, (uint32_t)status};
  for (;;) call(0x20, block);
}
