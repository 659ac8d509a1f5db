# cmake -DSOURCE_DIR=... -DFLAGS=... -DOUT=build_id.h -P build_id.cmake
# Build id = SHA-1 over names and contents of all sources and the compiler flags: no clock, no machine path.
file(GLOB files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/*.c ${SOURCE_DIR}/*.h ${SOURCE_DIR}/ports/*)
list(SORT files)
set(text "flags ${FLAGS}\n")
foreach(file IN LISTS files)
  file(SHA1 ${SOURCE_DIR}/${file} hash)
  string(APPEND text "${hash} ${file}\n")
endforeach()
string(SHA1 id "${text}")
file(WRITE ${OUT} "#define FW_BUILD_ID \"${id}\"\n")
