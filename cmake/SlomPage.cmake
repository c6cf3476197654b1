# slom_add_page(<target> <template> <variable> NAMESPACE <namespace> HEADER <header> FILES <file>...)
#
# Makes one web page of a template and the files that it names by `@file:NAME@`, and of that the string `variable`, which
# `header` declares, in `target`. Done when the target is built, and again when one of them changes. As a script (cmake -P)
# this file does the work itself.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(slom_page_script "${CMAKE_CURRENT_LIST_FILE}")
  function(slom_add_page target template variable)
    cmake_parse_arguments(page "" "NAMESPACE;HEADER" "FILES" ${ARGN})
    set(source "${CMAKE_CURRENT_BINARY_DIR}/${variable}.cpp")
    add_custom_command(
      OUTPUT "${source}"
      COMMAND "${CMAKE_COMMAND}" "-DTEMPLATE=${template}" "-DVARIABLE=${variable}" "-DNAMESPACE=${page_NAMESPACE}"
              "-DHEADER=${page_HEADER}" "-DOUTPUT=${source}" -P "${slom_page_script}"
      DEPENDS "${template}" "${slom_page_script}" ${page_FILES}
      COMMENT "Making a page of ${template}" VERBATIM)
    target_sources(${target} PRIVATE "${source}")
  endfunction()
  return()
endif()

get_filename_component(folder "${TEMPLATE}" DIRECTORY)
file(READ "${TEMPLATE}" page)
string(REGEX MATCHALL "@file:[^@]+@" marks "${page}")
foreach(mark IN LISTS marks)
  string(REGEX REPLACE "^@file:([^@]+)@$" "\\1" name "${mark}")
  file(READ "${folder}/${name}" content)
  string(REPLACE "${mark}" "${content}" page "${page}")
endforeach()
file(WRITE "${OUTPUT}" "#include \"${HEADER}\"\n\nnamespace ${NAMESPACE} {\n\n"
     "const std::string_view ${VARIABLE} = R\"slom_page(${page})slom_page\";\n\n}  // namespace ${NAMESPACE}\n")
