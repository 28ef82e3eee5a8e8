! A ring of oscillators for AUTO-07p, with M = NDIM/2 and diffusion between neighbours, as periodic orbits
! (IPS = 2):
!
!   x_i' = x_i - w y_i - x_i (x_i^2 + y_i^2) + k (x_{i-1} - 2 x_i + x_{i+1}),
!   y_i' = w x_i + y_i - y_i (x_i^2 + y_i^2) + k (y_{i-1} - 2 y_i + y_{i+1}).
!
! u = x_1, ..., x_M, y_1, ..., y_M; par(1) = w, par(2) = k, par(11) = the period. On the unit circle all
! oscillators move together, with the period 2 pi/w.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  integer :: m, i, before, after
  double precision :: x, y, square, k

  m = ndim/2
  k = par(2)
  if (ijac /= 0) dfdu = 0
  do i = 1, m
    before = modulo(i - 2, m) + 1
    after = modulo(i, m) + 1
    x = u(i)
    y = u(m + i)
    square = x*x + y*y
    f(i) = x - par(1)*y - x*square + k*(u(before) - 2*x + u(after))
    f(m + i) = par(1)*x + y - y*square + k*(u(m + before) - 2*y + u(m + after))
    if (ijac == 0) cycle
    dfdu(i, i) = 1 - square - 2*x*x - 2*k
    dfdu(i, m + i) = -par(1) - 2*x*y
    dfdu(m + i, i) = par(1) - 2*x*y
    dfdu(m + i, m + i) = 1 - square - 2*y*y - 2*k
    dfdu(i, before) = dfdu(i, before) + k
    dfdu(i, after) = dfdu(i, after) + k
    dfdu(m + i, m + before) = dfdu(m + i, m + before) + k
    dfdu(m + i, m + after) = dfdu(m + i, m + after) + k
  end do
  if (ijac == 0) return
  if (ijac == 1) return

  do i = 1, m
    dfdp(i, 1) = -u(m + i)
    dfdp(m + i, 1) = u(i)
  end do
end subroutine func

subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision, parameter :: pi = 4*atan(1d0)

  par(1) = 1d0
  par(2) = 0.3d0
  par(11) = 2*pi
  u(1:ndim/2) = cos(2*pi*t)
  u(ndim/2 + 1:ndim) = sin(2*pi*t)
end subroutine stpnt

subroutine pvls(ndim, u, par)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim), par(*)
end subroutine pvls

#include "unused.inc"
