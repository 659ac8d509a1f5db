/* Who this image is. FW_BUILD_ID is a hash of sources and flags, written by the build. */
#ifndef FORCEGATE_FIRMWARE_IDENTITY_H
#define FORCEGATE_FIRMWARE_IDENTITY_H

#include "build_id.h"
#include "parameters.h"

#define FW_PROTOCOL_MAJOR 1
#define FW_PROTOCOL_MINOR 0

#define FW_BOARD_SIZE 24
#define FW_BUILD_ID_SIZE 40
#define FW_ALGORITHM_SIZE 32

#endif
