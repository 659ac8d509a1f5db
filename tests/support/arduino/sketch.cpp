// The example firmware as the Arduino tools would compile it.

#include "tests/support/arduino/Arduino.h"

#include "rigs/firmware/examples/arduino_board/arduino_board.ino"
