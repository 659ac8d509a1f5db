#pragma once
// As much of the Arduino core as the example firmware uses, on this machine: the serial port is a terminal, the converter a
// counter.

#include <cstddef>
#include <cstdint>

constexpr std::uint8_t A0 = 14;
unsigned long micros();
int analogRead(std::uint8_t pin);

struct SerialPort {
  void begin(unsigned long baud);
  int available();
  int read();
  int availableForWrite();
  std::size_t write(std::uint8_t byte);
  std::size_t write(const std::uint8_t* bytes, std::size_t n);
};
extern SerialPort Serial;

void setup();
void loop();
