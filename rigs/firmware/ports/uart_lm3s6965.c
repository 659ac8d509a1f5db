/* UART port: PL011 of the LM3S6965 evaluation board, link protocol, no interrupts. Waits for room in the
   transmitter, because the board's UART is the only listener; on a bus with a free-running sensor the frame
   would be dropped and counted instead. */
#include <stdint.h>

#include "identity.h"
#include "link_device.h"

/* Read by the harness from the file, to know how to run the image. */
__attribute__((section(".forcegate"), used)) static const char kPort[] =
    "forcegate-port:uart:lm3s6965evb\0forcegate-build:" FW_BUILD_ID;

#define UART0 0x4000C000u
#define REGISTER(offset) (*(volatile uint32_t*)(UART0 + (offset)))
#define DR REGISTER(0x000)
#define FR REGISTER(0x018)
#define IBRD REGISTER(0x024)
#define FBRD REGISTER(0x028)
#define LCRH REGISTER(0x02C)
#define CTL REGISTER(0x030)
#define FR_RX_EMPTY (1u << 4)
#define FR_TX_FULL (1u << 5)

static LinkDevice device;

static int send(const uint8_t* bytes, uint32_t size) {
  for (uint32_t i = 0; i < size; ++i) {
    for (uint32_t spin = 0; FR & FR_TX_FULL; ++spin)
      if (spin > 100000000u) return 0;
    DR = bytes[i];
  }
  return 1;
}

int main(void) {
  *(volatile uint32_t*)0x400FE104u |= 1u; /* RCGC1: clock to UART0 */
  CTL = 0;
  IBRD = 6; /* 12 MHz / (16 x 115200) = 6.51 */
  FBRD = 33;
  LCRH = 0x70; /* 8N1, FIFO */
  CTL = 0x301;
  link_device_start(&device, "lm3s6965evb", send);
  for (;;)
    while (!(FR & FR_RX_EMPTY)) link_device_byte(&device, (uint8_t)DR);
}

void port_exit(int status) {
  (void)status;
  for (;;) {
  }
}
