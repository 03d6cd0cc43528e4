(* Derivatives as trees, and polynomials of one symbol with Sturm's theorem. Section 8 and the rule `roots` of docs/certificates.md. *)

open Text
open Tree

(* Derivatives: the shape is part of the format. *)

let sum' l = match List.filter (fun t -> not (equal t zero)) l with [] -> zero | [ t ] -> t | l -> Sum l
let product' l = match List.filter (fun t -> not (equal t one)) l with [] -> one | [ t ] -> t | l -> Prod l

let slope_of name =
  match name with
  | "exp" -> "exp(x)"
  | "sin" -> "cos(x)"
  | "cos" -> "-sin(x)"
  | "log" -> "1/x"
  | "atan" -> "1/(x*x + 1)"
  | "asin" -> "(1 - x*x)**(-1/2)"
  | "acos" -> "-(1 - x*x)**(-1/2)"
  | "tan" -> "cos(x)**(-2)"
  | "cot" -> "-sin(x)**(-2)"
  | "sec" -> "sin(x)/cos(x)**2"
  | "csc" -> "-cos(x)/sin(x)**2"
  | "sinh" -> "cosh(x)"
  | "cosh" -> "sinh(x)"
  | "tanh" -> "1 - tanh(x)**2"
  | "sqrt" -> "1/(2*sqrt(x))"
  | "abs" -> "x/abs(x)"
  | "erf" -> "2*exp(-x*x)*pi**(-1/2)"
  | _ -> refuse "no derivative of %s" name

let rec derive s t =
  if not (Names.mem s (symbols t)) then zero
  else
    match t with
    | Num _ | Pi | Sym _ -> one
    | Sum l -> sum' (List.map (derive s) l)
    | Prod l ->
        let term i =
          let l = List.mapi (fun j f -> if i = j then derive s f else f) l in
          if List.exists (equal zero) l then zero else product' l
        in
        sum' (List.init (List.length l) term)
    | Pow (b, e) -> (
        match !constant e with
        | Some q when Q.equal q Q.one -> derive s b
        | Some q ->
            let lower = if Q.equal q (Q.of_int 2) then b else Pow (b, Num (Q.sub q Q.one)) in
            product' [ e; lower; derive s b ]
        | None -> Prod [ t; derive s (Prod [ e; apply "log" b ]) ])
    | Fun ("atan2", [ y; x ]) ->
        let turn = subtract (Prod [ x; derive s y ]) (Prod [ y; derive s x ]) in
        Prod [ turn; Pow (Sum [ Prod [ x; x ]; Prod [ y; y ] ], Num Q.minus_one) ]
    | Fun (name, [ x ]) -> product' [ put [ ("x", x) ] (read_tree (slope_of name)); derive s x ]
    | Fun (name, _) -> refuse "no derivative of %s" name

(* Polynomials: coefficients from the constant upward, the last one not 0 *)

type polynomial = Q.t list

let is_null (p : polynomial) = p = []
let trim (p : Q.t list) : polynomial =
  let rec drop = function c :: l when Q.sign c = 0 -> drop l | l -> l in
  List.rev (drop (List.rev p))

let constant_polynomial c = trim [ c ]

let rec plus (a : polynomial) (b : polynomial) : Q.t list =
  match (a, b) with [], p | p, [] -> p | c :: a, d :: b -> Q.add c d :: plus a b

let add a b = trim (plus a b)
let scale c (p : polynomial) = trim (List.map (Q.mul c) p)
let degree p = List.length p - 1

let multiply (a : polynomial) (b : polynomial) =
  if degree a + degree b > 2000 then refuse "a polynomial of a degree above 2000";
  trim (List.fold_right (fun c sum -> plus (List.map (Q.mul c) b) (Q.zero :: sum)) a [])

let rec raise_to p n = if n = 0 then [ Q.one ] else multiply p (raise_to p (n - 1))
let at (p : polynomial) x = List.fold_right (fun c v -> Q.add c (Q.mul x v)) p Q.zero
let last p = List.nth p (degree p)
let derivative (p : polynomial) = match p with [] -> [] | _ :: l -> trim (List.mapi (fun i c -> Q.mul (Q.of_int (i + 1)) c) l)

(* Quotient and rest; the divisor is not 0. *)
let rec divide a b =
  if degree a < degree b then ([], a)
  else
    let c = Q.div (last a) (last b) and shift = degree a - degree b in
    let term = List.init shift (fun _ -> Q.zero) @ [ c ] in
    let q, r = divide (trim (add a (scale Q.minus_one (multiply term b)))) b in
    (add term q, r)

let monic p = if is_null p then p else scale (Q.inv (last p)) p
let rec common a b = if is_null b then monic a else common b (monic (snd (divide a b)))
let over a b = fst (divide a b)

(* The product of the factors of odd multiplicity (Yun's decomposition without squares) *)
let odd_part p =
  let rec go odd i factors repeated =
    if degree factors <= 0 then odd
    else
      let next = common factors repeated in
      let here = over factors next in
      go (if i land 1 = 1 then multiply odd here else odd) (i + 1) next (over repeated next)
  in
  let repeated = common p (derivative p) in
  go [ Q.one ] 1 (over p repeated) repeated

(* Removes the root r as often as it is there. *)
let rec without_root p r = if (not (is_null p)) && Q.sign (at p r) = 0 then without_root (over p [ Q.neg r; Q.one ]) r else p

(* Sturm: the number of different roots between the ends, where null is infinite and no end is a root. *)
let count_roots p (from, to_) =
  let rec chain a b = if is_null b then [ a ] else a :: chain b (scale Q.minus_one (snd (divide a b))) in
  let p = over p (common p (derivative p)) in
  let chain = chain p (derivative p) in
  let sign_at finish p =
    match finish with
    | `Number x -> Q.sign (at p x)
    | `Minus -> Q.sign (last p) * if degree p land 1 = 0 then 1 else -1
    | `Plus -> Q.sign (last p)
  in
  let changes finish =
    let signs = List.filter (fun s -> s <> 0) (List.map (sign_at finish) chain) in
    let rec go = function a :: (b :: _ as l) -> (if a <> b then 1 else 0) + go l | _ -> 0 in
    go signs
  in
  let finish none = function None -> none | Some x -> `Number x in
  changes (finish `Minus from) - changes (finish `Plus to_)

let has_root_between p (from, to_) =
  let p = List.fold_left (fun p e -> match e with Some x -> without_root p x | None -> p) p [ from; to_ ] in
  degree p > 0 && count_roots p (from, to_) > 0

(* A tree of one symbol as a quotient N/D *)
let rec fraction s t =
  let whole q = is_whole q && Z.leq (Z.abs q.Q.num) (Z.of_int 200) in
  match t with
  | Num q -> (constant_polynomial q, [ Q.one ])
  | Sym name when name = s -> ([ Q.zero; Q.one ], [ Q.one ])
  | Sum l ->
      let add_fraction (a, b) (c, d) =
        if b = d then (add a c, b) else (add (multiply a d) (multiply c b), multiply b d)
      in
      List.fold_left (fun f t -> add_fraction f (fraction s t)) ([], [ Q.one ]) l
  | Prod l ->
      let times (a, b) (c, d) = (multiply a c, multiply b d) in
      List.fold_left (fun f t -> times f (fraction s t)) ([ Q.one ], [ Q.one ]) l
  | Pow (b, e) -> (
      match !constant e with
      | Some q when whole q ->
          let n, d = fraction s b and k = Z.to_int q.Q.num in
          if k < 0 then (raise_to d (-k), raise_to n (-k)) else (raise_to n k, raise_to d k)
      | _ -> refuse "roots: no rational function")
  | Pi | Sym _ | Fun _ -> refuse "roots: no rational function"

(* A number between the ends that is no root of p *)
let number_between p (from, to_) =
  let spot i =
    let i = Q.of_int i in
    match (from, to_) with
    | None, None -> i
    | Some a, None -> Q.add a i
    | None, Some b -> Q.sub b i
    | Some a, Some b -> Q.add a (Q.div (Q.sub b a) (Q.add i Q.one))
  in
  let rec go i = if Q.sign (at p (spot i)) <> 0 then spot i else go (i + 1) in
  go 1

(* The conditions of `roots` for N/D; [holes] are numbers that are left out of the range. *)
let check_roots relation (n, d) ends holes =
  if is_null n || is_null d then refuse "roots: a polynomial 0";
  (match ends with Some a, Some b when Q.geq a b -> refuse "roots: no inner points" | _ -> ());
  let both = multiply n d in
  if relation <> Unequal then begin
    if Q.sign (at both (number_between both ends)) < 0 then refuse "roots: the wrong sign";
    if has_root_between (odd_part both) ends then refuse "roots: a change of sign"
  end;
  if relation <> AtLeast then begin
    let rec reduce n = let g = common n d in if degree g > 0 then reduce (over n g) else n in
    let rest = List.fold_left without_root (reduce n) holes in
    let is_root = function Some x -> Q.sign (at rest x) = 0 | None -> false in
    if is_root (fst ends) || is_root (snd ends) then refuse "roots: a zero at an end";
    if has_root_between rest ends then refuse "roots: a zero inside the range"
  end
