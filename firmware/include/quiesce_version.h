/// Which firmware this is. tools/src/quiesce/__init__.py has the same version.
#ifndef QUIESCE_VERSION_H
#define QUIESCE_VERSION_H

#define QUIESCE_VERSION_MAJOR 0
#define QUIESCE_VERSION_MINOR 1
#define QUIESCE_VERSION_PATCH 0

#endif
