# Kernels as byte arrays inside the library.
#
# Included, this file defines lightwell_embed_programs(). Run as a script (cmake -P) it embeds one program:
# quoted includes are flattened, each file once, and `#line` directives keep the true file and line in the
# compiler's messages. Includes in angle brackets are left alone (portable.h uses them for C++). A quoted
# include is looked up beside the including file, then below the program's kernel directory, then below
# this file's; it must not depend on #if. src/compute/program_source.cpp flattens LIGHTWELL_KERNEL_DIR by the same rules, and a test compares.

if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.25)

  # Appends the flattened text of `file` to the variable `flat`, its files to `files`.
  macro(lightwell_flatten file)
    cmake_path(SET lw_path NORMALIZE "${file}")
    if(NOT "${lw_path}" IN_LIST files)
      list(APPEND files "${lw_path}")
      lightwell_flatten_new("${lw_path}")
    endif()
  endmacro()

  function(lightwell_flatten_new path)
    file(READ "${path}" rest)
    cmake_path(GET path PARENT_PATH folder)
    set(root "${KERNEL_DIR}")
    cmake_path(IS_PREFIX CMAKE_CURRENT_LIST_DIR "${path}" shared)
    if(shared)
      set(root "${CMAKE_CURRENT_LIST_DIR}")
    endif()
    file(RELATIVE_PATH shown "${root}" "${path}")
    # From here on `flat` ends with a #line directive and `rest` begins with the line break after it;
    # `line` is the number of the line behind that break.
    set(line 1)
    set(rest "\n${rest}")
    string(APPEND flat "#line 1 \"${shown}\"")
    while(rest MATCHES "\n[ \t]*#[ \t]*include[ \t]+\"([^\"\n]+)\"[^\n]*")
      set(match "${CMAKE_MATCH_0}")
      set(name "${CMAKE_MATCH_1}")
      string(FIND "${rest}" "${match}" at)
      string(SUBSTRING "${rest}" 0 ${at} before)
      string(LENGTH "${match}" length)
      math(EXPR at "${at} + ${length}")
      string(SUBSTRING "${rest}" ${at} -1 rest)
      string(APPEND flat "${before}\n")
      string(REGEX MATCHALL "\n" breaks "${before}")
      list(LENGTH breaks count)
      math(EXPR line "${line} + ${count} + 1")
      if(EXISTS "${folder}/${name}")
        lightwell_flatten("${folder}/${name}")
      elseif(EXISTS "${KERNEL_DIR}/${name}")
        lightwell_flatten("${KERNEL_DIR}/${name}")
      elseif(EXISTS "${CMAKE_CURRENT_LIST_DIR}/${name}")
        lightwell_flatten("${CMAKE_CURRENT_LIST_DIR}/${name}")
      else()
        message(FATAL_ERROR "${path}: included file \"${name}\" found neither beside it nor in ${KERNEL_DIR}")
      endif()
      string(APPEND flat "#line ${line} \"${shown}\"")
    endwhile()
    string(APPEND flat "${rest}")
    if(NOT rest MATCHES "\n$")
      string(APPEND flat "\n")
    endif()
    set(flat "${flat}" PARENT_SCOPE)
    set(files "${files}" PARENT_SCOPE)
  endfunction()

  set(flat "")
  set(files "")
  lightwell_flatten("${KERNEL_DIR}/${PROGRAM}.cl")
  file(WRITE "${OUTPUT}.cl" "${flat}")
  file(READ "${OUTPUT}.cl" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(REPEAT "0x..," 20 row)
  string(REGEX REPLACE "(${row})" "\\1\n" bytes "${bytes}")
  file(WRITE "${OUTPUT}"
    "// Generated from ${PROGRAM}.cl by embed.cmake.\n"
    "#include <cstddef>\n"
    "namespace lightwell {\n"
    "extern const unsigned char ${SYMBOL}[];\n"
    "extern const std::size_t ${SYMBOL}Size;\n"
    "const unsigned char ${SYMBOL}[] = {\n${bytes}};\n"
    "const std::size_t ${SYMBOL}Size = sizeof(${SYMBOL});\n"
    "}  // namespace lightwell\n")
  string(REPLACE " " "\\ " files "${files}")
  string(REPLACE ";" " " files "${files}")
  string(REPLACE " " "\\ " target "${OUTPUT}")
  file(WRITE "${OUTPUT}.d" "${target}: ${files}\n")
  return()
endif()

set(LIGHTWELL_EMBED_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

# lightwell_embed_programs(<sources> TABLE <name> DIRECTORY <dir> PROGRAMS <program>...)
# Sets <sources> to generated C++ files that define `const EmbeddedProgram <name>[]` and `<name>Count`
# (see src/compute/program.h). A program is a path below <dir> without ".cl".
function(lightwell_embed_programs sources)
  cmake_parse_arguments(arg "" "TABLE;DIRECTORY" "PROGRAMS" ${ARGN})
  set(generated "")
  set(declarations "")
  set(rows "")
  set(row_count 0)
  foreach(program IN LISTS arg_PROGRAMS)
    string(MAKE_C_IDENTIFIER "${arg_TABLE}_${program}" symbol)
    set(output "${CMAKE_CURRENT_BINARY_DIR}/${arg_TABLE}/${symbol}.cpp")
    add_custom_command(OUTPUT "${output}"
      COMMAND "${CMAKE_COMMAND}" "-DPROGRAM=${program}" "-DKERNEL_DIR=${arg_DIRECTORY}"
              "-DSYMBOL=${symbol}" "-DOUTPUT=${output}" -P "${LIGHTWELL_EMBED_SCRIPT}"
      DEPENDS "${arg_DIRECTORY}/${program}.cl" "${LIGHTWELL_EMBED_SCRIPT}"
      DEPFILE "${output}.d"
      COMMENT "Embedding kernel ${program}"
      VERBATIM)
    list(APPEND generated "${output}")
    string(APPEND declarations
      "extern const unsigned char ${symbol}[];\nextern const std::size_t ${symbol}Size;\n")
    string(APPEND rows "    {\"${program}\", ${symbol}, ${symbol}Size},\n")
    math(EXPR row_count "${row_count} + 1")
  endforeach()
  set(table "${CMAKE_CURRENT_BINARY_DIR}/${arg_TABLE}/table.cpp")
  file(CONFIGURE OUTPUT "${table}" CONTENT
"// Generated by embed.cmake.
#include \"compute/program.h\"
namespace lightwell {
${declarations}extern const EmbeddedProgram ${arg_TABLE}[];
extern const std::size_t ${arg_TABLE}Count;
const EmbeddedProgram ${arg_TABLE}[] = {
${rows}};
const std::size_t ${arg_TABLE}Count = ${row_count};
}  // namespace lightwell
" @ONLY)
  set(${sources} ${generated} "${table}" PARENT_SCOPE)
endfunction()
