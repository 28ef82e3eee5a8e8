! The nonimpacting periodic orbits of Mita's actuator for AUTO-07p, as periodic orbits of an autonomous system
! (IPS = 2): an oscillator with the stable limit cycle s = sin 2 omega t, c = cos 2 omega t forces the block,
!
!   q' = u,   u' = V^2 (1 - c) / (2 (1 - q)^2) - q - 0.04 u,
!   s' = s + 2 omega c - s (s^2 + c^2),   c' = c - 2 omega s - c (s^2 + c^2).
!
! u(1:4) = q, u, s, c; par(1) = V, par(2) = omega, par(11) = the period. FULL_DIGITS writes every V with
! 17 digits to fort.55, since AUTO's own files hold 11.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: gap, force, r, w

  w = 2*par(2)
  gap = 1 - u(1)
  force = (1 - u(4))/(2*gap**2)
  r = u(3)**2 + u(4)**2
  f(1) = u(2)
  f(2) = par(1)**2*force - u(1) - 0.04d0*u(2)
  f(3) = u(3) + w*u(4) - u(3)*r
  f(4) = u(4) - w*u(3) - u(4)*r
  if (ijac == 0) return

  dfdu = 0
  dfdu(1, 2) = 1
  dfdu(2, 1) = 2*par(1)**2*force/gap - 1
  dfdu(2, 2) = -0.04d0
  dfdu(2, 4) = -par(1)**2/(2*gap**2)
  dfdu(3, 3) = 1 - r - 2*u(3)**2
  dfdu(3, 4) = w - 2*u(3)*u(4)
  dfdu(4, 3) = -w - 2*u(3)*u(4)
  dfdu(4, 4) = 1 - r - 2*u(4)**2
  if (ijac == 1) return

  dfdp(:, 1) = [0d0, 2*par(1)*force, 0d0, 0d0]
end subroutine func

! At V = 0.01 the linear response q = p + a cos(2 omega t) + b sin(2 omega t) is the orbit to 2e-7.
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision, parameter :: pi = 4*atan(1d0)
  double precision :: w, p, a, b, d

  par(1) = 0.01d0
  par(2) = 0.45d0
  par(11) = pi/par(2)
  w = 2*par(2)
  p = par(1)**2/2
  d = (1 - w**2)**2 + (0.04d0*w)**2
  a = -p*(1 - w**2)/d
  b = -p*0.04d0*w/d
  u(1) = p + a*cos(2*pi*t) + b*sin(2*pi*t)
  u(2) = w*(b*cos(2*pi*t) - a*sin(2*pi*t))
  u(3) = sin(2*pi*t)
  u(4) = cos(2*pi*t)
end subroutine stpnt

subroutine pvls(ndim, u, par)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim), par(*)
#ifdef FULL_DIGITS
  write (55, '(es24.16)') par(1)
#endif
end subroutine pvls

#include "unused.inc"
