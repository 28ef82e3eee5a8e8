! The nonimpacting periodic orbits of Mita's actuator for AUTO-07p, as a boundary-value problem (IPS = 7)
! on 0 <= t <= 1 with the period pi/omega of the forcing as the unit of time:
!
!   q' = T u,   u' = T (V^2 sin^2(theta) / (1 - q)^2 - q - 0.04 u),   theta' = pi,   T = pi/omega,
!   q(1) = q(0),   u(1) = u(0),   theta(0) = 0.
!
! u(1:3) = q, u, theta; par(1) = V, par(2) = omega. FULL_DIGITS writes every V with 17 digits to fort.55,
! since AUTO's own files hold 11.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, parameter :: pi = 4*atan(1d0)
  double precision :: period, gap, force

  period = pi/par(2)
  gap = 1 - u(1)
  force = (sin(u(3))/gap)**2
  f(1) = period*u(2)
  f(2) = period*(par(1)**2*force - u(1) - 0.04d0*u(2))
  f(3) = pi
  if (ijac == 0) return

  dfdu = 0
  dfdu(1, 2) = period
  dfdu(2, 1) = period*(2*par(1)**2*force/gap - 1)
  dfdu(2, 2) = -0.04d0*period
  dfdu(2, 3) = period*(par(1)/gap)**2*sin(2*u(3))
  if (ijac == 1) return

  dfdp(:, 1) = [0d0, 2*period*par(1)*force, 0d0]
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
  w = 2*par(2)
  p = par(1)**2/2
  d = (1 - w**2)**2 + (0.04d0*w)**2
  a = -p*(1 - w**2)/d
  b = -p*0.04d0*w/d
  u(1) = p + a*cos(2*pi*t) + b*sin(2*pi*t)
  u(2) = w*(b*cos(2*pi*t) - a*sin(2*pi*t))
  u(3) = pi*t
end subroutine stpnt

subroutine bcnd(ndim, par, icp, nbc, u0, u1, fb, ijac, dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc, *)

  fb = [u1(1) - u0(1), u1(2) - u0(2), u0(3)]
  if (ijac == 0) return

  dbc(:, 1:2*ndim) = 0
  dbc(1, 1) = -1
  dbc(1, ndim + 1) = 1
  dbc(2, 2) = -1
  dbc(2, ndim + 2) = 1
  dbc(3, 3) = 1
  if (ijac == 1) return

  dbc(:, 2*ndim + 1) = 0
end subroutine bcnd

subroutine pvls(ndim, u, par)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim), par(*)
#ifdef FULL_DIGITS
  write (55, '(es24.16)') par(1)
#endif
end subroutine pvls

subroutine icnd
end subroutine icnd

subroutine fopt
end subroutine fopt
