/* A 1 kHz clock by SysTick at 25 MHz (MPS2 boards) and the cost of what happens between two of its readings. */
#ifndef FORCEGATE_FIRMWARE_TICK_H
#define FORCEGATE_FIRMWARE_TICK_H

#include <stdint.h>

#define TICK_CLOCK_HZ 25000000u
#define TICK_RATE_HZ 1000u

void tick_start(void);
uint32_t tick_wait(void);                /* sleeps until the next tick; a reading of the clock */
uint32_t tick_since(uint32_t reading);   /* cycles of TICK_CLOCK_HZ since that reading; notes a tick that was missed */
uint32_t tick_late(void);                /* samples that were not done before the next tick */

#endif
