#ifndef RECURVE_DATA_GENERATE_LAYERS_H
#define RECURVE_DATA_GENERATE_LAYERS_H

#include <recurve/core/exceptions.h>

namespace recurve::generate {

/// distance from the wall after `layer` layers that grow by `growth` from `first`.
inline double layer_height(double first, double growth, int layer)
{
  double sum = 0;
  for (int k = 0; k < layer; ++k)
    sum = growth * sum + first;
  return sum;
}

/// the growth with which `layers` layers fill `whole`, by bisection.
inline double layer_growth(double first, double whole, int layers)
{
  if (first * layers > whole)
    throw Input_error("the layers are too thick for the space around the wall");
  double low = 1, high = 10;
  for (int step = 0; step < 100; ++step)
  {
    const double middle = 0.5 * (low + high);
    (layer_height(first, middle, layers) < whole ? low : high) = middle;
  }
  return low;
}

} // namespace recurve::generate

#endif
