# Warnings for our own targets; foreign headers are system headers and stay quiet.
add_library(recurve_warnings INTERFACE)
target_compile_options(recurve_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                  $<$<BOOL:${RECURVE_WARNINGS_AS_ERRORS}>:-Werror>)
