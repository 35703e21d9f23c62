#pragma once

namespace palpate::mesh {

/// Listens to VTK's error messages in this thread as long as it lives; from the first one on VTK prints none.
class VtkErrors {
public:
    VtkErrors();
    bool heard() const;
};

}  // namespace palpate::mesh
