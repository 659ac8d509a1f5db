# cmake -DHEADER=comp.h -DSOURCE_DIR=rigs/firmware -DOUT=folder -P copy_with_header.cmake
# Copies the firmware and puts an exported compensator beside it, so that the build id covers both.
file(REMOVE_RECURSE ${OUT})
file(GLOB sources ${SOURCE_DIR}/*.c ${SOURCE_DIR}/*.h)
file(COPY ${sources} ${SOURCE_DIR}/ports DESTINATION ${OUT})
configure_file(${HEADER} ${OUT}/compensation.h COPYONLY)
file(TOUCH ${OUT}/compensation.h)
