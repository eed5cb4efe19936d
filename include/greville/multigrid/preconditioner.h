#ifndef greville_multigrid_preconditioner_h
#define greville_multigrid_preconditioner_h

#include <greville/base/compatibility.h>

namespace greville
{
  /**
   * An approximate inverse S of a mass matrix M, to be used as the smoother
   * x += S (b - M x) or inside a Krylov method.
   */
  class Preconditioner
  {
  public:
    virtual ~Preconditioner() = default;

    /**
     * dst = S src.
     */
    virtual void
    vmult(VectorType &dst, const VectorType &src) const = 0;

    /**
     * dst = S^T src. The default is for symmetric S.
     */
    virtual void
    Tvmult(VectorType &dst, const VectorType &src) const
    {
      vmult(dst, src);
    }

    /**
     * Bytes of this object on this process, as far as it knows them.
     */
    virtual std::size_t
    memory_consumption() const = 0;
  };
} // namespace greville

#endif
