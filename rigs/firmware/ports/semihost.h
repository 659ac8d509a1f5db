/* The four semihosting calls that the block port needs (Arm semihosting specification, SYS_OPEN ...). */
#ifndef FORCEGATE_FIRMWARE_SEMIHOST_H
#define FORCEGATE_FIRMWARE_SEMIHOST_H

#include <stdint.h>

#define SEMIHOST_READ_BINARY 1
#define SEMIHOST_WRITE_BINARY 5

int32_t semihost_open(const char* path, uint32_t mode);           /* handle or -1 */
int semihost_read_all(int32_t handle, void* data, uint32_t size); /* 1 = complete, 0 = end or fault */
int semihost_write_all(int32_t handle, const void* data, uint32_t size);
void semihost_exit(int status) __attribute__((noreturn));

#endif
