#ifndef RECURVE_TESTS_SUPPORT_ORDINARY_USER_H
#define RECURVE_TESTS_SUPPORT_ORDINARY_USER_H

#include <sys/fsuid.h>
#include <unistd.h>

namespace recurve::test {

/// While it lives, this thread may read and write no more than a user without rights: permissions mean something to
/// root too.
class Ordinary_user
{
public:
  Ordinary_user()
  {
    if (geteuid() == 0)
      setfsuid(nobody);
  }
  ~Ordinary_user()
  {
    if (geteuid() == 0)
      setfsuid(0);
  }
  Ordinary_user(const Ordinary_user&) = delete;
  Ordinary_user& operator=(const Ordinary_user&) = delete;

private:
  static constexpr uid_t nobody = 65534;
};

} // namespace recurve::test

#endif
