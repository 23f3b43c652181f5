// The inner loops of the fast summation. simd_kernels.h includes this file once per instruction set, inside a namespace
// and under a target pragma, with RECURVE_SIMD_WIDTH doubles to a vector. Everything is plain IEEE arithmetic in an order
// that does not depend on the width, so that every instruction set gives the same bits. Nothing of std is called: what is
// instantiated here might be compiled for this instruction set and then be shared with code for others.

inline constexpr int width = RECURVE_SIMD_WIDTH;

typedef double Reals __attribute__((vector_size(width * sizeof(double)), aligned(sizeof(double)), may_alias));
typedef float Floats __attribute__((vector_size(width * sizeof(double)), aligned(sizeof(float)), may_alias));
typedef float Half_floats __attribute__((vector_size(width * sizeof(float)), aligned(sizeof(float)), may_alias));

inline Reals& reals(double* p)
{
  return *reinterpret_cast<Reals*>(p);
}
inline const Reals& reals(const double* p)
{
  return *reinterpret_cast<const Reals*>(p);
}

inline Reals root(Reals q)
{
  return RECURVE_SIMD_ROOT(pd, q);
}
inline Floats root(Floats q)
{
  return RECURVE_SIMD_ROOT(ps, q);
}

/// r^N with q = r^2
template <int N, class V>
inline V power(const V q, const V r)
{
  if constexpr (N == 0)
    return V{} + 1;
  else if constexpr (N == 1)
    return r;
  else if constexpr (N == 2)
    return q;
  else if constexpr (N % 2 == 1)
    return power<N - 1>(q, r) * r;
  else if constexpr (N % 4 == 0)
  {
    const V half = power<N / 2>(q, r);
    return half * half;
  }
  else
    return power<N - 2>(q, r) * q;
}

/// r^-A + c r^-B at q = r^2, with one root and one division: instructions, exact to the last bit, and on recent
/// processors faster than an approximation and Newton's iteration.
template <int A, int B, class V, class Real>
inline V weight(const V q, Real c)
{
  const V r = root(q);
  if constexpr (A <= B)
    return (power<B - A>(q, r) + c) / power<B>(q, r);
  else
    return (1 + c * power<A - B>(q, r)) / power<A>(q, r);
}

/// adds to the sums of `target_count` targets (a multiple of `width`) those over all sources, in double precision.
template <int A, int B>
void add_direct(const Charges<double>& s, Index source_count, const Coordinates<double>& targets, Index target_count,
                double near_factor, const Sums& sums)
{
  // closer than this (in units of the influence's length) is as good as at the source; keeps the weight finite
  constexpr double closest_squared = 1e-60;

  for (Index t = 0; t < target_count; t += width)
  {
    const Reals x = reals(targets.x + t), y = reals(targets.y + t), z = reals(targets.z + t);
    Reals sum = {}, sum_x = {}, sum_y = {}, sum_z = {};
    for (Index m = 0; m < source_count; ++m)
    {
      const Reals dx = x - s.x[m], dy = y - s.y[m], dz = z - s.z[m];
      Reals q = dx * dx + dy * dy + dz * dz;
      q = q < closest_squared ? Reals{} + closest_squared : q;
      const Reals w = weight<A, B>(q, near_factor);
      sum += s.weight[m] * w;
      sum_x += s.weighted_x[m] * w;
      sum_y += s.weighted_y[m] * w;
      sum_z += s.weighted_z[m] * w;
    }
    reals(sums.weight + t) += sum;
    reals(sums.x + t) += sum_x;
    reals(sums.y + t) += sum_y;
    reals(sums.z + t) += sum_z;
  }
}

/// to[m] = factor * (from[m] - origin); `count` is a multiple of `width`.
inline void to_relative(const double* from, Index count, double origin, double factor, float* to)
{
  for (Index m = 0; m < count; m += width)
    *reinterpret_cast<Half_floats*>(to + m) = __builtin_convertvector(factor * (reals(from + m) - origin), Half_floats);
}
inline void to_relative(const double* from, Index count, double origin, double factor, double* to)
{
  for (Index m = 0; m < count; m += width)
    reals(to + m) = factor * (reals(from + m) - origin);
}

/// sums[m] += factor * part[m]
inline void add_scaled(double* sums, const Floats& part, double factor)
{
  const float* p = reinterpret_cast<const float*>(&part);
  reals(sums) += factor * __builtin_convertvector(*reinterpret_cast<const Half_floats*>(p), Reals);
  reals(sums + width) += factor * __builtin_convertvector(*reinterpret_cast<const Half_floats*>(p + width), Reals);
}
inline void add_scaled(double* sums, const Reals& part, double factor)
{
  reals(sums) += factor * part;
}

/// the same in single precision, for pairs that are far apart compared with the distances of both from the origin.
/// `target_count` is a multiple of `2 * width`.
template <int A, int B>
void add_direct(const Charges<float>& s, Index source_count, const Coordinates<float>& targets, Index target_count,
                float near_factor, const Sums& sums)
{
  // so few terms are summed in single precision that their rounding stays near that of one
  constexpr Index run_length = 32;

  for (Index first = 0; first < source_count; first += run_length)
  {
    const Index last = first + run_length < source_count ? first + run_length : source_count;
    for (Index t = 0; t < target_count; t += 2 * width)
    {
      const Floats x = *reinterpret_cast<const Floats*>(targets.x + t);
      const Floats y = *reinterpret_cast<const Floats*>(targets.y + t);
      const Floats z = *reinterpret_cast<const Floats*>(targets.z + t);
      Floats sum = {}, sum_x = {}, sum_y = {}, sum_z = {};
      for (Index m = first; m < last; ++m)
      {
        const Floats dx = x - s.x[m], dy = y - s.y[m], dz = z - s.z[m];
        const Floats w = weight<A, B>(dx * dx + dy * dy + dz * dz, near_factor);
        sum += s.weight[m] * w;
        sum_x += s.weighted_x[m] * w;
        sum_y += s.weighted_y[m] * w;
        sum_z += s.weighted_z[m] * w;
      }
      add_scaled(sums.weight + t, sum, 1);
      add_scaled(sums.x + t, sum_x, 1);
      add_scaled(sums.y + t, sum_y, 1);
      add_scaled(sums.z + t, sum_z, 1);
    }
  }
}

/// The vector of Reals.
template <class Real>
struct Vector_of
{
  typedef Real type __attribute__((vector_size(width * sizeof(double)), aligned(sizeof(Real)), may_alias));
  // NOLINTNEXTLINE(bugprone-sizeof-expression): of double itself too
  static constexpr int size = width * static_cast<int>(sizeof(double) / sizeof(Real));
};

template <class Real>
inline typename Vector_of<Real>::type& vector_at(Real* p)
{
  return *reinterpret_cast<typename Vector_of<Real>::type*>(p);
}
template <class Real>
inline const typename Vector_of<Real>::type& vector_at(const Real* p)
{
  return *reinterpret_cast<const typename Vector_of<Real>::type*>(p);
}

/// radial[m][lane] = (2 d/dq)^m (q^(-A/2) + near_factors[lane] q^(-B/2)) at the squared lengths of the offsets.
template <int A, int B, class Real>
void radial_derivatives(const Pack<Real>* offsets, const Pack<Real>& near_factors, int degree, Pack<Real>* radial)
{
  for (int at = 0; at < lanes<Real>; at += Vector_of<Real>::size)
  {
    const auto x = vector_at(offsets[0] + at), y = vector_at(offsets[1] + at), z = vector_at(offsets[2] + at);
    const auto q = x * x + y * y + z * z;
    const auto r = root(q), u2 = 1 / q;
    auto far = 1 / power<A>(q, r), near = vector_at(near_factors + at) / power<B>(q, r);
    for (int m = 0; m <= degree; ++m)
    {
      vector_at(radial[m] + at) = far + near;
      far = far * u2 * static_cast<Real>(-(A + 2 * m));
      near = near * u2 * static_cast<Real>(-(B + 2 * m));
    }
  }
}

/// the derivatives of degree `d` from those of degree d - 1 and d - 2, by D_(a+e) = x_e D_a + a_e D_(a-e). Of one degree,
/// the monomials with a factor follow each other as their quotients do, so that no table is asked.
template <class Real, class Vector>
inline void raise_derivatives(int d, const Vector x, const Vector y, const Vector z, int at, Pack<Real>* derivatives)
{
  Pack<Real>* term = derivatives + term_count(d - 1);
  const Pack<Real>*parent = derivatives + term_count(d - 2), *grandparent = derivatives + term_count(d - 3);
  for (int power = d; power > 1; --power)
    for (int n = d - power; n >= 0; --n)
    {
      const Vector value = x * vector_at(*parent++ + at);
      vector_at(*term++ + at) = value + static_cast<Real>(power - 1) * vector_at(*grandparent++ + at);
    }
  for (int n = d; n > 0; --n)
    vector_at(*term++ + at) = x * vector_at(*parent++ + at);
  // Without x: the last ones of either degree.
  parent -= d;
  grandparent -= d - 1;
  for (int power = d; power > 1; --power)
  {
    const Vector value = y * vector_at(*parent++ + at);
    vector_at(*term++ + at) = value + static_cast<Real>(power - 1) * vector_at(*grandparent++ + at);
  }
  vector_at(*term++ + at) = y * vector_at(*parent + at);
  Vector value = z * vector_at(*parent + at);
  if (d > 1)
    value += static_cast<Real>(d - 1) * vector_at(*(grandparent - 1) + at);
  vector_at(*term + at) = value;
}

/// all derivatives up to `degree` of a radial function at the offsets: derivatives[term][lane].
template <class Real>
void derivative_tensor(int degree, const Pack<Real>* offsets, const Pack<Real>* radial, Pack<Real>* derivatives)
{
  for (int at = 0; at < lanes<Real>; at += Vector_of<Real>::size)
  {
    const auto x = vector_at(offsets[0] + at), y = vector_at(offsets[1] + at), z = vector_at(offsets[2] + at);
    vector_at(derivatives[0] + at) = vector_at(radial[degree] + at);
    // From those of the m+1st radial derivative follow, in place and from the highest degree down, those of the m-th.
    for (int m = degree - 1; m >= 0; --m)
    {
      for (int d = degree - m; d > 0; --d)
        raise_derivatives<Real>(d, x, y, z, at, derivatives);
      vector_at(derivatives[0] + at) = vector_at(radial[m] + at);
    }
  }
}

/// element i of the result is element i / 2 + `Offset` of `a` (even i) or of `b` (odd i).
template <int Offset, class Vector, int... I>
inline Vector interleave(const Vector a, const Vector b, std::integer_sequence<int, I...>)
{
  return __builtin_shufflevector(a, b, (I / 2 + I % 2 * static_cast<int>(sizeof...(I)) + Offset)...);
}

/// columns[m][lane] = factors[degree of m / 4][lane] * rows[lane][m] for m < count, a multiple of 16.
template <class Real>
void transpose(const Expansion_table& table, const Real* const* rows, int count, const Pack<Real>* factors,
               Pack<Real>* columns)
{
  using Vector = typename Vector_of<Real>::type;
  constexpr int n = Vector_of<Real>::size;
  constexpr std::make_integer_sequence<int, n> elements;
  for (int at = 0; at < lanes<Real>; at += n)
    for (int m = 0; m < count; m += n)
    {
      // Interleaving the first half of the rows with the second transposes them when it is done log2(n) times.
      Vector block[n], next[n];
#pragma GCC unroll 16
      for (int i = 0; i < n; ++i)
        block[i] = vector_at(rows[at + i] + m);
#pragma GCC unroll 4
      for (int step = 1; step < n; step *= 2)
      {
#pragma GCC unroll 8
        for (int i = 0; i < n / 2; ++i)
        {
          next[2 * i] = interleave<0>(block[i], block[i + n / 2], elements);
          next[2 * i + 1] = interleave<n / 2>(block[i], block[i + n / 2], elements);
        }
#pragma GCC unroll 16
        for (int i = 0; i < n; ++i)
          block[i] = next[i];
      }
#pragma GCC unroll 16
      for (int i = 0; i < n; ++i)
        vector_at(columns[m + i] + at) = block[i] * vector_at(factors[table.degree((m + i) / 4)] + at);
    }
}

/// local[4 b + c] += factors * sum over a of moments[4 a + c] derivatives[a b], for `N` successive b of one degree.
template <int N, class Real>
inline void contract(const Expansion_table& table, int b, int end, int at, const Pack<Real>* derivatives,
                            const Pack<Real>* moments, const Real* factors, Pack<Real>* local)
{
  using Vector = typename Vector_of<Real>::type;
  Vector sums[N][4] = {};
  const std::int16_t* products[N];
#pragma GCC unroll 4
  for (int n = 0; n < N; ++n)
    products[n] = table.products(b + n);
  for (int a = 0; a < end; ++a)
  {
    Vector d[N];
#pragma GCC unroll 4
    for (int n = 0; n < N; ++n)
      d[n] = vector_at(derivatives[products[n][a]] + at);
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c)
    {
      const Vector m = vector_at(moments[4 * a + c] + at);
  #pragma GCC unroll 4
    for (int n = 0; n < N; ++n)
        sums[n][c] += m * d[n];
    }
  }
#pragma GCC unroll 4
  for (int n = 0; n < N; ++n)
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c)
      vector_at(local[4 * (b + n) + c] + at) += vector_at(factors + at) * sums[n][c];
}

/// adds, lane by lane, the expansion of a source cell to the local expansion of the target cell:
/// local[4 b + c][lane] += target_factors[degree of b][lane] * sum over a of source_factors[degree of a][lane]
/// moments[lane][4 a + c] derivatives[a b][lane].
template <class Real>
void translate(const Expansion_table& table, int degree, const Pack<Real>* derivatives, const Real* const* moments,
               const Pack<Real>* source_factors, const Pack<Real>* target_factors, Pack<Real>* transposed,
               Pack<Real>* local)
{
  constexpr int group = width == 8 ? 4 : 2;
  const int terms = term_count(degree);
  transpose(table, moments, (4 * terms + 15) / 16 * 16, source_factors, transposed);
  for (int at = 0; at < lanes<Real>; at += Vector_of<Real>::size)
  {
    int b = 0;
    for (int d = 0; d <= degree; ++d)
    {
      // As many terms of one degree at a time as there are registers for their sums.
      const int last = term_count(d), end = term_count(degree - d);
      for (; b + group <= last; b += group)
        contract<group>(table, b, end, at, derivatives, transposed, target_factors[d], local);
      for (; b + 2 <= last; b += 2)
        contract<2>(table, b, end, at, derivatives, transposed, target_factors[d], local);
      if (b < last)
        contract<1>(table, b++, end, at, derivatives, transposed, target_factors[d], local);
    }
  }
}

/// adds the expansion of one source cell to the sums of as many targets as there are lanes, whose derivatives are given:
/// factor * sum over a < `terms` of moments[4 a + c] derivatives[a][lane].
template <class Real>
void add_expansion(int terms, const Pack<Real>* derivatives, const Real* moments, double factor, const Sums& sums)
{
  for (int at = 0; at < lanes<Real>; at += Vector_of<Real>::size)
  {
    typename Vector_of<Real>::type sum = {}, sum_x = {}, sum_y = {}, sum_z = {};
    // from the smallest terms to the largest
    for (int a = terms - 1; a >= 0; --a)
    {
      const auto d = vector_at(derivatives[a] + at);
      sum += moments[4 * a] * d;
      sum_x += moments[4 * a + 1] * d;
      sum_y += moments[4 * a + 2] * d;
      sum_z += moments[4 * a + 3] * d;
    }
    add_scaled(sums.weight + at, sum, factor);
    add_scaled(sums.x + at, sum_x, factor);
    add_scaled(sums.y + at, sum_y, factor);
    add_scaled(sums.z + at, sum_z, factor);
  }
}

/// monomials[term] = x^i y^j z^k / (i! j! k!)
inline void scaled_monomials(const Expansion_table& table, int degree, const Reals* x, Reals* monomials)
{
  monomials[0] = Reals{} + 1.0;
  for (int g = 1; g < term_count(degree); ++g)
  {
    const Expansion_table::Recurrence& r = table.recurrence(g);
    monomials[g] = monomials[r.parent] * x[r.axis] * inverse_integers[r.power + 1];
  }
}

/// moments[4 a + c] += sum over sources of charge c times (-position)^a / a!; `source_count` is a multiple of lanes<double>,
/// positions are relative to the center, `lane_sums` is room for 4 term_count(degree) packs.
inline void add_moments(const Expansion_table& table, int degree, const Charges<double>& s, Index source_count,
                        Pack<double>* lane_sums, double* moments)
{
  const int terms = term_count(degree);
  for (int m = 0; m < 4 * terms; ++m)
    for (int lane = 0; lane < lanes<double>; ++lane)
      lane_sums[m][lane] = 0;
  Reals monomials[max_term_count];
  for (Index first = 0; first < source_count; first += width)
  {
    const int at = static_cast<int>(first % lanes<double>);
    const Reals x[3] = {-reals(s.x + first), -reals(s.y + first), -reals(s.z + first)};
    scaled_monomials(table, degree, x, monomials);
    for (int a = 0; a < terms; ++a)
    {
      reals(lane_sums[4 * a] + at) += monomials[a] * reals(s.weight + first);
      reals(lane_sums[4 * a + 1] + at) += monomials[a] * reals(s.weighted_x + first);
      reals(lane_sums[4 * a + 2] + at) += monomials[a] * reals(s.weighted_y + first);
      reals(lane_sums[4 * a + 3] + at) += monomials[a] * reals(s.weighted_z + first);
    }
  }
  for (int m = 0; m < 4 * terms; ++m)
    for (int lane = 0; lane < lanes<double>; ++lane)
      moments[m] += lane_sums[m][lane];
}

/// adds to the sums of `target_count` targets (a multiple of `width`) the local expansion at their positions, which are
/// relative to its center.
inline void add_local(const Expansion_table& table, int degree, const double* local, const Coordinates<double>& targets,
                      Index target_count, const Sums& sums)
{
  Reals monomials[max_term_count];
  for (Index t = 0; t < target_count; t += width)
  {
    const Reals x[3] = {reals(targets.x + t), reals(targets.y + t), reals(targets.z + t)};
    scaled_monomials(table, degree, x, monomials);
    Reals sum = {}, sum_x = {}, sum_y = {}, sum_z = {};
    // from the smallest terms to the largest
    for (int b = term_count(degree) - 1; b >= 0; --b)
    {
      sum += local[4 * b] * monomials[b];
      sum_x += local[4 * b + 1] * monomials[b];
      sum_y += local[4 * b + 2] * monomials[b];
      sum_z += local[4 * b + 3] * monomials[b];
    }
    reals(sums.weight + t) += sum;
    reals(sums.x + t) += sum_x;
    reals(sums.y + t) += sum_y;
    reals(sums.z + t) += sum_z;
  }
}
