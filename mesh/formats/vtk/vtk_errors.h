#pragma once

namespace palpate::mesh {

/// Listens to VTK's error messages in this thread as long as it lives. From the first one on VTK prints none, and
/// begins no threads.
class VtkErrors {
public:
    VtkErrors();
    bool heard() const;
};

}  // namespace palpate::mesh
