/// One instance: a lock file in the state folder with the process id in it.
#ifndef QUIESCED_INSTANCE_LOCK_H
#define QUIESCED_INSTANCE_LOCK_H

#include <string>

namespace quiesced {

class InstanceLock {
  public:
    /// Makes the folder where it is missing (not its parents). Throws InputError where another
    /// process holds the lock (with its id) or the folder cannot be used.
    explicit InstanceLock(const std::string &folder);
    InstanceLock(const InstanceLock &) = delete;
    InstanceLock &operator=(const InstanceLock &) = delete;
    ~InstanceLock();

    /// Id of the process that holds the lock, 0: nobody. Changes nothing.
    static long holder(const std::string &folder);

  private:
    int fd_;
};

} // namespace quiesced

#endif
