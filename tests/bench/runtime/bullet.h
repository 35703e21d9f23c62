#pragma once

namespace palpate::bench {

/// Bullet's soft bodies on the same lattices, in the same run; or that the bench was built without them.
void print_bullet();

}  // namespace palpate::bench
