#include <recurve/io/mesh_io.h>
#include <recurve/run/curve_mesh.h>

int main(int argc, char** argv)
{
  if (argc == 3)
    recurve::write_mesh(recurve::curve_mesh(recurve::read_mesh(argv[1]), {.degree = 3}), argv[2]);
}
