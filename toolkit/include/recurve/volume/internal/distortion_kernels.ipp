// Gradients of maps between cells, and what derivatives by them mean for the nodes, for a batch of cells of one type,
// one to a lane. distortion_kernels.h includes this file once per instruction set, inside a namespace and under a target
// pragma, with RECURVE_SIMD_WIDTH doubles to a vector. Everything is plain IEEE arithmetic, lane by lane, so that the
// bits of a cell depend neither on the width nor on its companions.

inline constexpr int width = RECURVE_SIMD_WIDTH;

typedef double Reals __attribute__((vector_size(width * sizeof(double)), aligned(sizeof(double)), may_alias));

inline Reals& reals(double* p, int number)
{
  return *reinterpret_cast<Reals*>(p + static_cast<std::ptrdiff_t>(number) * width);
}
inline const Reals& reals(const double* p, int number)
{
  return *reinterpret_cast<const Reals*>(p + static_cast<std::ptrdiff_t>(number) * width);
}

inline void load(const double* from, int matrix, Reals* m)
{
  for (int i = 0; i < 9; ++i)
    m[i] = reals(from, 9 * matrix + i);
}

inline void store(const Reals* m, double* to, int matrix)
{
  for (int i = 0; i < 9; ++i)
    reals(to, 9 * matrix + i) = m[i];
}

/// result = derivative of det f.
inline void find_cofactors(const Reals* f, Reals* result)
{
  for (int r = 0; r < 3; ++r)
  {
    const Reals* const a = f + 3 * ((r + 1) % 3);
    const Reals* const b = f + 3 * ((r + 2) % 3);
    for (int c = 0; c < 3; ++c)
      result[3 * r + c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
  }
}

/// result = a times the transpose of b.
inline void multiply_transposed(const Reals* a, const Reals* b, Reals* result)
{
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      result[3 * r + c] = a[3 * r] * b[3 * c] + a[3 * r + 1] * b[3 * c + 1] + a[3 * r + 2] * b[3 * c + 2];
}

/// sum += m (x, y, z).
inline void add_product(const Reals* m, double x, double y, double z, Reals* sum)
{
  for (int r = 0; r < 3; ++r)
    sum[r] += m[3 * r] * x + m[3 * r + 1] * y + m[3 * r + 2] * z;
}

/// gradients on the reference cell, of the field that has `vectors` at the nodes.
inline void find_reference_gradients(const Distortion_view& points, const double* vectors, double* gradients)
{
  const double* d = points.derivatives;
  for (int q = 0; q < points.count; ++q)
  {
    Reals j[9] = {};
    for (int m = 0; m < points.nodes; ++m, d += 3)
      for (int r = 0; r < 3; ++r)
      {
        const Reals v = reals(vectors, 3 * m + r);
        j[3 * r] += v * d[0];
        j[3 * r + 1] += v * d[1];
        j[3 * r + 2] += v * d[2];
      }
    store(j, gradients, q);
  }
}

/// turns gradients of displacements on the reference cell into those of the map from the straight cell, with their
/// squared norms and determinants.
inline void find_map_gradients(const Distortion_view& points, const double* inverses, double* gradients,
                               double* squares, double* determinants)
{
  for (int q = 0; q < points.count; ++q)
  {
    Reals j[9], inverse[9], f[9], cofactors[9];
    load(gradients, q, j);
    load(inverses, q, inverse);
    Reals square = {};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
      {
        Reals entry = j[3 * r] * inverse[c] + j[3 * r + 1] * inverse[3 + c] + j[3 * r + 2] * inverse[6 + c];
        if (r == c)
          entry += 1.0;
        f[3 * r + c] = entry;
        square += entry * entry;
      }
    store(f, gradients, q);
    find_cofactors(f, cofactors);
    reals(squares, q) = square;
    reals(determinants, q) = f[0] * cofactors[0] + f[1] * cofactors[1] + f[2] * cofactors[2];
  }
}

/// derivatives by the displacements of the nodes of a sum over points, from those by |F|^2 and det F.
inline void find_slopes(const Distortion_view& points, const double* inverses, const double* gradients,
                        const double* by_square, const double* by_det, double* slopes)
{
  for (int n = 0; n < 3 * points.nodes; ++n)
    reals(slopes, n) = Reals{};
  const double* d = points.derivatives;
  for (int q = 0; q < points.count; ++q)
  {
    Reals f[9], inverse[9], cofactors[9], stress[9];
    load(gradients, q, f);
    load(inverses, q, inverse);
    find_cofactors(f, cofactors);
    for (int i = 0; i < 9; ++i)
      f[i] = 2.0 * reals(by_square, q) * f[i] + reals(by_det, q) * cofactors[i];
    multiply_transposed(f, inverse, stress);
    for (int m = 0; m < points.nodes; ++m, d += 3)
      add_product(stress, d[0], d[1], d[2], &reals(slopes, 3 * m));
  }
}

/// positive parts of the second derivatives by the displacements of each node: xx, yy, zz, yz, zx, xy.
inline void find_blocks(const Distortion_view& points, const double* inverses, const double* gradients,
                        const double* by_square, const double* inflating, double* blocks)
{
  for (int n = 0; n < 6 * points.nodes; ++n)
    reals(blocks, n) = Reals{};
  const double* d = points.derivatives;
  for (int q = 0; q < points.count; ++q)
  {
    Reals f[9], inverse[9], cofactors[9], metric[9], normal[9];
    load(gradients, q, f);
    load(inverses, q, inverse);
    find_cofactors(f, cofactors);
    multiply_transposed(inverse, inverse, metric);
    multiply_transposed(cofactors, inverse, normal);
    for (int m = 0; m < points.nodes; ++m, d += 3)
    {
      Reals along[3] = {}, across[3] = {};
      add_product(metric, d[0], d[1], d[2], along);
      add_product(normal, d[0], d[1], d[2], across);
      const Reals stretching = 2.0 * reals(by_square, q) * (along[0] * d[0] + along[1] * d[1] + along[2] * d[2]);
      for (int i = 0; i < 3; ++i)
      {
        const Reals weighted = reals(inflating, q) * across[(i + 1) % 3];
        reals(blocks, 6 * m + (i + 1) % 3) += stretching + weighted * across[(i + 1) % 3];
        reals(blocks, 6 * m + 3 + i) += weighted * across[(i + 2) % 3];
      }
    }
  }
}
