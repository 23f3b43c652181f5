#ifndef RECURVE_TESTS_VOLUME_READ_MSH_H
#define RECURVE_TESTS_VOLUME_READ_MSH_H

#include <recurve/core/types.h>
#include <recurve/elements/node_layout.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace recurve::tests {

/// Cells of a mesh file, canonical order, and their nodes.
struct Msh_cells
{
  std::vector<Point> nodes;
  std::map<Element_type, std::vector<Index>> cells;
};

/// Reads nodes and cells of one degree from an MSH 2.2 file, ASCII or binary; just enough for trustworthy test data.
class Msh_file
{
public:
  Msh_file(const std::filesystem::path& path, int degree) : in_(path, std::ios::binary), degree_(degree) {}

  Msh_cells read()
  {
    find("$MeshFormat");
    double version;
    int mode, size;
    in_ >> version >> mode >> size;
    is_binary_ = mode == 1;
    find("$Nodes");
    read_nodes();
    find("$Elements");
    read_elements();
    return std::move(result_);
  }

private:
  /// What the format calls the complete element of each degree from 1 to 4.
  struct Family
  {
    Element_type type;
    std::array<int, 4> codes;
  };
  static constexpr std::array<Family, 7> families = {{{Element_type::line, {1, 8, 26, 27}},
                                                      {Element_type::triangle, {2, 9, 21, 23}},
                                                      {Element_type::quadrangle, {3, 10, 36, 37}},
                                                      {Element_type::tetrahedron, {4, 11, 29, 30}},
                                                      {Element_type::hexahedron, {5, 12, 92, 93}},
                                                      {Element_type::prism, {6, 13, 90, 91}},
                                                      {Element_type::pyramid, {7, 14, 118, 119}}}};

  void find(const std::string& section)
  {
    for (std::string line; std::getline(in_, line);)
      if (line == section)
        return;
    throw std::runtime_error("no " + section);
  }

  template <class T>
  T next()
  {
    T value;
    if (is_binary_)
      in_.read(reinterpret_cast<char*>(&value), sizeof(T));
    else
      in_ >> value;
    if (!in_)
      throw std::runtime_error("file too short");
    return value;
  }

  int count()
  {
    std::string line;
    std::getline(in_, line);
    return std::stoi(line);
  }

  void read_nodes()
  {
    for (int left = count(); left > 0; --left)
    {
      const int id = next<int>();
      Point p;
      for (double& x : p)
        x = next<double>();
      ids_[id] = static_cast<Index>(result_.nodes.size());
      result_.nodes.push_back(p);
    }
  }

  void read_elements()
  {
    for (int left = count(); left > 0;)
    {
      if (!is_binary_)
        next<int>(); // its number
      const int code = next<int>();
      int in_run = is_binary_ ? next<int>() : 1;
      const int tags = next<int>();
      left -= in_run;
      for (; in_run > 0; --in_run)
      {
        if (is_binary_)
          next<int>();
        for (int t = 0; t < tags; ++t)
          next<int>();
        read_element(code);
      }
    }
  }

  void read_element(int code)
  {
    if (code == 15) // a point
    {
      next<int>();
      return;
    }
    for (const auto& [type, codes] : families)
      for (int degree = 1; degree <= 4; ++degree)
        if (codes[static_cast<std::size_t>(degree - 1)] == code)
        {
          std::vector<Index> nodes(static_cast<std::size_t>(node_count(type, degree)));
          for (const int canonical : canonical_of_foreign(Node_order::gmsh, type, degree))
            nodes[static_cast<std::size_t>(canonical)] = ids_.at(next<int>());
          if (reference_element(type).dimension == 3 && degree == degree_)
            result_.cells[type].insert(result_.cells[type].end(), nodes.begin(), nodes.end());
          return;
        }
    throw std::runtime_error("element of type " + std::to_string(code));
  }

  std::ifstream in_;
  int degree_;
  bool is_binary_ = false;
  std::map<int, Index> ids_;
  Msh_cells result_;
};

} // namespace recurve::tests

#endif
