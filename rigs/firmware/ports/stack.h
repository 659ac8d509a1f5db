/* High-water mark of the stack: startup.c paints the upper part of the RAM, what is no longer painted was used. */
#ifndef FORCEGATE_FIRMWARE_STACK_H
#define FORCEGATE_FIRMWARE_STACK_H

#include <stdint.h>

#define STACK_PAINTED_BYTES 32768u
#define STACK_PAINT 0xA5A5A5A5u

uint32_t stack_used_bytes(void); /* at most STACK_PAINTED_BYTES */

#endif
