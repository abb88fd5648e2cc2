# Cross-builds the firmware for the H8S/2128.

# Sources of shared/servo that run on the H8 too, relative to shared/.
function(kaz_servo_sources out)
  set(${out} servo/tick.c servo/joints.c servo/joint_loop.c servo/protection.c servo/shutdown.c
             servo/health.c servo/safety.c servo/status.c servo/motion.c servo/settings.c servo/bench.c
             servo/telemetry.c servo/commands.c servo/joint_replies.c servo/replies.c
             servo/telemetry_frames.c servo/requests.c servo/actions.c servo/outputs.c servo/store.c
             servo/startup.c PARENT_SCOPE)
endfunction()

find_program(KAZ_H8_GCC h8300-hms-gcc)
find_program(KAZ_H8_LD h8300-hms-ld)
find_program(KAZ_H8_OBJCOPY h8300-hms-objcopy)
find_program(KAZ_H8_OBJDUMP h8300-hms-objdump)
set(KAZ_H8_TOOLS FALSE)
if(KAZ_H8_GCC AND KAZ_H8_LD AND KAZ_H8_OBJCOPY AND KAZ_H8_OBJDUMP)
  set(KAZ_H8_TOOLS TRUE)
endif()

# -fno-strict-aliasing avoids known wrong code of this compiler; no frame pointer, no library.
set(KAZ_H8_FLAGS -ms -O2 -g -Wall -Werror -ffreestanding -std=gnu99 -fomit-frame-pointer
                 -fno-strict-aliasing)

# The flash writer: DIR/writer.bin, as it lies in RAM, and COPY_DIR/writer.bin.
function(kaz_flash_writer name dir copy_dir shared_root)
  set(firmware ${PROJECT_SOURCE_DIR}/firmware)
  file(MAKE_DIRECTORY ${dir})
  set(objects)
  foreach(stem writer_start writer writer_flash writer_second_stage)
    set(source ${firmware}/${stem}.c)
    if(stem STREQUAL writer_start)
      set(source ${firmware}/${stem}.S)
    endif()
    set(object ${dir}/${stem}.o)
    set(to_section)
    if(stem STREQUAL writer_second_stage)
      set(to_section COMMAND ${KAZ_H8_OBJCOPY} --rename-section .text=.rest
                             --rename-section .rodata=.rest2 ${object})
    endif()
    # -Os: boot mode takes 2048 bytes.
    add_custom_command(
      OUTPUT ${object}
      COMMAND ${KAZ_H8_GCC} ${KAZ_H8_FLAGS} -Os -I${shared_root} -I${PROJECT_SOURCE_DIR}
              -MMD -MF ${object}.d -MT ${object} -c ${source} -o ${object}
      ${to_section}
      DEPENDS ${source}
      DEPFILE ${object}.d
      COMMENT "H8 ${name}: ${stem}" VERBATIM)
    list(APPEND objects ${object})
  endforeach()
  set(generators ${PROJECT_SOURCE_DIR}/tools/repo/gen)
  add_custom_command(
    OUTPUT ${dir}/writer.bin ${dir}/writer.coff ${copy_dir}/writer.bin
    COMMAND ${KAZ_H8_LD} -m h8300s --fatal-warnings -T ${firmware}/writer.ld -o ${dir}/writer.coff ${objects}
    COMMAND Python3::Interpreter -B ${generators}/writer_report.py ${KAZ_H8_OBJDUMP} ${dir}/writer.coff
    COMMAND ${KAZ_H8_OBJCOPY} -O binary -j .text -j .rest ${dir}/writer.coff ${dir}/writer.bin
    COMMAND ${CMAKE_COMMAND} -E copy ${dir}/writer.bin ${copy_dir}/writer.bin
    DEPENDS ${objects} ${firmware}/writer.ld ${generators}/writer_report.py ${generators}/stack_bound.py
            ${generators}/coff.py
    COMMENT "H8 ${name}: flash writer" VERBATIM)
endfunction()

# kaz_firmware_image(NAME name SHARED_DIR dir OUTPUT_DIR dir [FLAGS flag ...] [C_JOINT_LOOP] [ALL])
# Target NAME_firmware: OUTPUT_DIR/NAME.coff (with symbols) and NAME.mot (S-records), NAME.objects/writer.bin
# (the flash writer, which the loader's block holds too) and a copy of it beside NAME.mot, from the sources
# in firmware/ and those of a folder that is, or is a copy of, shared/: a test can build a patched copy.
# Joint limits and build id are those of the main build. FLAGS come after KAZ_H8_FLAGS. C_JOINT_LOOP takes
# shared/servo/joint_loop.c as the compiler makes it instead of firmware/joint_loop.S, to measure its cost.
# Without a cross compiler the target does not exist.
function(kaz_firmware_image)
  cmake_parse_arguments(ARG "ALL;C_JOINT_LOOP" "NAME;SHARED_DIR;OUTPUT_DIR" "FLAGS" ${ARGN})
  if(NOT KAZ_H8_TOOLS)
    return()
  endif()
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  set(firmware ${PROJECT_SOURCE_DIR}/firmware)
  set(generators ${PROJECT_SOURCE_DIR}/tools/repo/gen)
  set(generated ${PROJECT_BINARY_DIR}/generated)
  get_filename_component(shared_root ${ARG_SHARED_DIR} DIRECTORY)
  kaz_servo_sources(servo)
  set(loop)
  if(NOT ARG_C_JOINT_LOOP)
    list(REMOVE_ITEM servo servo/joint_loop.c)
    set(loop ${firmware}/joint_loop.S ${firmware}/joint_loop_check.c)
  endif()
  list(TRANSFORM servo PREPEND ${ARG_SHARED_DIR}/)
  set(sources
    ${loop} ${firmware}/analog_interrupt.S
    ${firmware}/serial_interrupts.S
    ${firmware}/vectors.S ${firmware}/image_header.c
    ${firmware}/start.S ${firmware}/main.c ${firmware}/clock.c ${firmware}/pins.c
    ${firmware}/serial.c ${firmware}/analog.c ${firmware}/memory.c ${firmware}/flash.c
    ${ARG_SHARED_DIR}/protocol/crc16.c ${ARG_SHARED_DIR}/protocol/frame.c
    ${ARG_SHARED_DIR}/protocol/messages.c ${ARG_SHARED_DIR}/board/table.c ${servo})
  set(loader_sources
    ${firmware}/loader_start.S ${firmware}/loader.c ${firmware}/loader_crc16.c
    ${firmware}/loader_writer.S)
  set(ram_sources ${firmware}/flash_ram.c)
  kaz_flash_writer(${ARG_NAME} ${ARG_OUTPUT_DIR}/${ARG_NAME}.objects ${ARG_OUTPUT_DIR} ${shared_root})

  set(objects_dir ${ARG_OUTPUT_DIR}/${ARG_NAME}.objects)
  file(MAKE_DIRECTORY ${objects_dir})
  set(objects)
  foreach(source IN LISTS sources loader_sources ram_sources)
    get_filename_component(stem ${source} NAME_WE)
    set(object ${objects_dir}/${stem}.o)
    set(to_section)
    if(source IN_LIST loader_sources)
      # The loader has sections of its own: this linker cannot place an input file by a pattern.
      set(to_section COMMAND ${KAZ_H8_OBJCOPY} --rename-section .text=.ltext
                             --rename-section .rodata=.lconst ${object})
    elseif(source IN_LIST ram_sources)
      set(to_section COMMAND ${KAZ_H8_OBJCOPY} --rename-section .text=.ramtext ${object})
    endif()
    add_custom_command(
      OUTPUT ${object}
      COMMAND ${KAZ_H8_GCC} ${KAZ_H8_FLAGS} ${ARG_FLAGS} -I${shared_root} -I${PROJECT_SOURCE_DIR}
              -I${generated} -Wa,-I${objects_dir}
              -MMD -MF ${object}.d -MT ${object} -c ${source} -o ${object}
      ${to_section}
      # The first of shared/ stands for all: a patched copy is made in one go.
      DEPENDS ${source} ${objects_dir}/writer.bin ${ARG_SHARED_DIR}/protocol/crc16.c ${generated}/kz_limits.h
              ${generated}/kz_build_id.h kaz_generated_headers
      DEPFILE ${object}.d
      COMMENT "H8 ${ARG_NAME}: ${stem}" VERBATIM)
    list(APPEND objects ${object})
  endforeach()

  set(coff ${ARG_OUTPUT_DIR}/${ARG_NAME}.coff)
  set(mot ${ARG_OUTPUT_DIR}/${ARG_NAME}.mot)
  # No -lgcc: that library is for another CPU. What it would have to supply is undefined here.
  add_custom_command(
    OUTPUT ${coff} ${mot} ${ARG_OUTPUT_DIR}/${ARG_NAME}.sizes
    COMMAND ${KAZ_H8_LD} -m h8300s --fatal-warnings -T ${firmware}/kaz.ld -o ${coff} ${objects}
    COMMAND Python3::Interpreter -B ${generators}/stamp_image.py ${coff}
    # By its bare name, which becomes the first record.
    COMMAND ${KAZ_H8_OBJCOPY} -O srec ${ARG_NAME}.coff ${ARG_NAME}.mot
    COMMAND Python3::Interpreter -B ${generators}/firmware_report.py ${KAZ_H8_OBJDUMP}
            ${ARG_NAME}.coff ${ARG_NAME}.sizes
    WORKING_DIRECTORY ${ARG_OUTPUT_DIR}
    DEPENDS ${objects} ${firmware}/kaz.ld ${generators}/stamp_image.py ${generators}/coff.py
            ${generators}/stack_bound.py ${generators}/tick_divisions.py
            ${generators}/firmware_report.py
    COMMENT "H8 ${ARG_NAME}: link" VERBATIM)
  set(all)
  if(ARG_ALL)
    set(all ALL)
  endif()
  add_custom_target(${ARG_NAME}_firmware ${all} DEPENDS ${coff} ${mot})
endfunction()
